"""Offers of another protocol, which the service ignores (RFC 9110, 7.8), and addresses too long to parse."""

from httptools import HttpParserError, HttpParserUpgrade
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

LONGEST_URL = 65_535
"""Characters of the longest address that the parser takes."""


class Protocol(HttpToolsProtocol):
    """uvicorn's HTTP/1.1 protocol; here a request that offers another protocol keeps its body.

    Java's HTTP client offers h2c with its first request. The parser ends such a request after its head and takes the
    body for the next request. The parser therefore gets the head again, without the offer.
    """

    head = b""

    def on_url(self, url: bytes) -> None:
        """Add a part of the address, up to the longest that can be parsed: the application refuses it as too long."""
        super().on_url(url[: LONGEST_URL - len(self.url)])

    def on_headers_complete(self) -> None:
        """Start the request, unless its head is to be parsed again."""
        offers = self.parser.should_upgrade() and self.parser.get_method() != b"CONNECT"
        self.head = self._head_without_offer() if offers else b""
        if not self.head:
            super().on_headers_complete()

    def on_message_complete(self) -> None:
        """End the request, unless its head is to be parsed again."""
        if not self.head:
            super().on_message_complete()

    def data_received(self, data: bytes) -> None:
        """Parse bytes that have arrived; answer 400 to malformed ones."""
        self._unset_keepalive_if_required()
        rest = memoryview(data)
        try:
            while (end := self._offered_at(rest)) is not None:
                self.parser.feed_data(self.head)
                rest = rest[end:]
        except HttpParserError:
            self.logger.warning("Invalid HTTP request received.")
            self.send_400_response("Invalid HTTP request received.")

    def _offered_at(self, data: memoryview) -> int | None:
        """Parse data; return the end of a head with an offer, where parsing stopped, or None if all data are parsed."""
        try:
            self.parser.feed_data(data)
        except HttpParserUpgrade as offer:
            return int(offer.args[0])
        return None

    def _head_without_offer(self) -> bytes:
        start = b"%b %b HTTP/%b" % (self.parser.get_method(), self.url, self.parser.get_http_version().encode())
        fields = [b"%b: %b" % field for field in self.headers if field[0] != b"upgrade"]
        return b"\r\n".join([start, *fields, b"", b""])
