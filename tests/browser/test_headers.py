"""Access that headers deny and permit in a real browser."""

from playwright.sync_api import Browser, expect

from tests.browser.conftest import Visitor

OTHERS = """async ({ server, icon }) => {
  const read = (address, options) => fetch(server + address, options).then(reply => reply.status, () => "kept out");
  const picture = new Promise(done => Object.assign(new Image(),
    { onload: () => done("shown"), onerror: () => done("kept out"), src: server + icon }));
  return [
    await read("/api/v1/catalogue/HPN-20A-5"),
    await read("/api/v1/selections", { headers: { "X-API-Key": "none" } }),
    await read("/api/v1/catalogue", { mode: "no-cors" }),
    await picture,
  ];
}"""


def test_scripts_of_a_permitted_origin_read_the_api_and_no_page_embeds_anything(chromium: Browser, server: str) -> None:
    context = chromium.new_context(bypass_csp=True)  # CSP of the page that plays another application
    page = context.new_page()
    page.goto(server.replace("127.0.0.1", "localhost"))
    icon = page.locator('link[rel="icon"]').get_attribute("href")

    result = page.evaluate(OTHERS, {"server": server, "icon": icon})

    assert result == [200, 200, "kept out", "kept out"]
    context.close()


def test_the_page_copies_in_spite_of_the_features_it_does_without(visitor: Visitor) -> None:
    page = visitor.open("/catalogue/HPN-20A-5")
    page.context.grant_permissions(["clipboard-write"])  # the headless shell has no prompt; a policy still applies
    button = page.locator("[data-copies]").first
    outcome = button.get_attribute("data-done") or ""

    button.click()

    expect(button).to_have_text(outcome)
    assert page.evaluate("document.featurePolicy?.allowsFeature('camera') ?? false") is False


def test_a_style_that_a_page_does_not_bring_along_has_no_effect(chromium: Browser, server: str) -> None:
    page = chromium.new_page()
    page.goto(f"{server}/catalogue")

    colour = page.evaluate(
        """() => {
          const text = document.body.appendChild(document.createElement("p"));
          text.setAttribute("style", "color: rgb(1, 2, 3)");
          document.head.appendChild(document.createElement("style")).textContent = "p { color: rgb(1, 2, 3) }";
          return getComputedStyle(text).color;
        }"""
    )

    assert colour != "rgb(1, 2, 3)"
    page.close()
