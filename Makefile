# Every target installs what it needs first. The stamps live inside what they vouch for, so deleting the folder is enough
# to start again; they depend on the locks, so an up-to-date tree goes straight to its work.
PYTHON ?= python3
HOST ?= $(or $(HPN_HOST),127.0.0.1)
PORT ?= $(or $(HPN_PORT),8000)
UPGRADE ?=# make lock UPGRADE=--upgrade

VENV := .venv
BIN := $(VENV)/bin
TOOLS := $(VENV)/build
UV := $(TOOLS)/bin/uv
# Builds with the locked hatchling, which stands beside the environment as uv does.
BUILD := PYTHONPATH="$(CURDIR)/$(TOOLS)" $(UV)
MODULES := frontend/node_modules
ASSETS := frontend/dist/manifest.json
COMPILED := frontend/dist/templates/.all
# Enough to run is installed, or all of it. Once a tree has the tools, `make run` must not take them away again.
FOR := $(if $(filter check test soak mutants bench screenshots browser messages licences sbom audit containers,$(MAKECMDGOALS))$(wildcard $(VENV)/.dev),dev,run)
PAGE_FOR := $(if $(filter check test soak,$(MAKECMDGOALS))$(wildcard $(MODULES)/.dev),dev,run)
ENVIRONMENT := $(VENV)/.$(FOR)
PACKAGES := $(MODULES)/.$(PAGE_FOR)
# Debian keeps nginx where the path of a plain user doesn't lead.
export PATH := $(PATH):/usr/sbin
# Where the machine has no npm, a wheel brings one; it stays out of the way of an installed Node.
NODE := $(if $(shell command -v npm),,$(VENV)/.node)
ifdef NODE
export PATH := $(CURDIR)/$(VENV)/node/bin:$(PATH)
endif
# Python keeps what it has compiled: without it each process of a test run compiles the package, and pytest its files, anew.
unexport PYTHONDONTWRITEBYTECODE
# The machine's own certificates, for networks that inspect traffic.
export UV_SYSTEM_CERTS ?= true
export NODE_USE_SYSTEM_CA ?= 1

.PHONY: run install assets package test soak mutants check bench screenshots browser office curl nginx java pdfua messages lock licences sbom audit digests certificates restore clean
.DELETE_ON_ERROR:

run: install
	@echo "HPN Select is at http://$(HOST):$(PORT) until Ctrl+C"
	@exec $(BIN)/hpn serve --host "$(HOST)" --port "$(PORT)"

install: $(ENVIRONMENT) $(ASSETS) $(COMPILED)
assets: $(ASSETS) $(COMPILED)

# Lighthouse measures, so that nothing runs beside it; the rest takes two cores, a file at a time but for the browsers.
MEASURED := tests/browser/test_lighthouse.py
TOGETHER := --ignore tests/browser --numprocesses 3 --dist loadfile --no-loadscope-reorder
# Figures and decisions once more, as a processor without this one's vector loops and with other last bits has them: what
# hangs on floating point, so that of the units neither words nor files nor the command line; ties move last bits themselves.
WORDS := application catalogue_errors catalogue_files check_texts cli cli_help facts fields hints link_messages links motion_links motors plots reader supplements symbols translations typed words
NUMERIC := tests/reference tests/property tests/unit $(WORDS:%=--ignore tests/unit/test_%.py) --ignore tests/property/test_ties.py --numprocesses 3 --dist loadfile --no-loadscope-reorder
ELSEWHERE = env NPY_DISABLE_CPU_FEATURES="$$($(BIN)/python -m tests.last_bits)" HPN_TEST_LAST_BITS
BROWSERS := tests/browser --ignore tests/browser/test_lighthouse.py --numprocesses 3 --dist load
# Parts of a run: one that fails keeps no other from running, and the last lines name it.
PARTS = failed=; part() { name=$$1; shift; echo "$$name: $$*"; "$$@" || failed="$$failed $$name"; }
ENDED = for name in $$failed; do echo "make $@: failed: $$name" >&2; done; [ -z "$$failed" ]
test: install browser office curl nginx
ifdef PYTEST_ARGS
	$(BIN)/pytest $(PYTEST_ARGS)
else
	@$(PARTS); \
	part measured $(BIN)/pytest $(MEASURED); \
	part together $(BIN)/pytest $(TOGETHER); \
	part another-processor $(ELSEWHERE)=mixed $(BIN)/pytest $(NUMERIC); \
	part browsers $(BIN)/pytest $(BROWSERS); \
	$(ENDED)
endif

# Tests that are long by nature, in their long form: hundreds of kills, examples by the thousand, Lighthouse over all pages.
# Nothing runs beside tests of waiting times.
UNDER_LOAD := tests/reliability/test_load.py tests/reliability/test_loop.py tests/operations/test_peers.py
soak: install browser office curl nginx java pdfua
	@$(PARTS); \
	part measured $(BIN)/pytest --soak $(MEASURED); \
	part under-load $(BIN)/pytest --soak $(UNDER_LOAD); \
	part together $(BIN)/pytest --soak $(TOGETHER) $(addprefix --ignore ,$(UNDER_LOAD)); \
	part browsers $(BIN)/pytest --soak $(BROWSERS); \
	for way in up down mixed; do part "last-bits-$$way" $(ELSEWHERE)=$$way $(BIN)/pytest $(NUMERIC); done; \
	$(ENDED)

# Each small change of the modules that decide has to make a test fail; one that no test finds is explained or listed.
mutants: install
	$(BIN)/python -m tools.mutants $(ONLY)

check: $(ENVIRONMENT)
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/djlint --quiet --check frontend/templates
	$(BIN)/djlint --quiet --lint frontend/templates
	$(BIN)/mypy
	$(BIN)/lint-imports

# Times that a user feels, of this checkout and a plain service; with BESIDE=folder, of another installed checkout as well.
bench: install browser
	$(BIN)/python -m tools.benchmarks $(if $(BESIDE),--beside "$(BESIDE)") $(ONLY)

screenshots: install browser
	$(BIN)/python -m tools.screenshots

# --- Python -----------------------------------------------------------------------------------------------------------

$(UV): requirements-build.lock
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "Python 3.11 or newer is needed" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip' 2>/dev/null || { apt-get update && apt-get install -y --no-install-recommends python3-venv; }
	$(PYTHON) -m venv $(VENV)
	@rm -rf $(TOOLS)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes --target $(TOOLS) -r $<
	@touch $@

$(VENV)/.run: requirements.lock
$(VENV)/.dev: requirements-dev.lock
$(VENV)/.run $(VENV)/.dev: $(UV) pyproject.toml
	$(UV) pip sync --quiet --compile-bytecode --python $(BIN)/python --require-hashes $(filter %.lock,$^)
	$(BUILD) pip install --quiet --python $(BIN)/python --offline --no-build-isolation --no-deps --editable .
	@touch $@

# Wheel and sdist for pip, in dist/; the folders at the top of the checkout go into both.
package: install
	$(BUILD) build --quiet --python $(BIN)/python --offline --no-build-isolation --out-dir dist

# --- Page -------------------------------------------------------------------------------------------------------------

$(VENV)/.node: requirements-node.lock | $(UV)
	$(UV) venv --quiet --clear --python $(BIN)/python $(VENV)/node
	$(UV) pip sync --quiet --python $(VENV)/node/bin/python --require-hashes $<
	@touch $@

$(MODULES)/.run: NPM_FLAGS := --omit=dev
$(MODULES)/.run $(MODULES)/.dev: frontend/package.json frontend/package-lock.json frontend/.npmrc | $(NODE)
	cd frontend && npm ci --loglevel=error $(NPM_FLAGS)
	@touch $@

# fonttools stands beside the environment, too.
$(ASSETS): $(shell find frontend/static 2>/dev/null) $(wildcard frontend/*.py backend/hpn/explain/drawings/*.css) $(PACKAGES) | $(ENVIRONMENT)
	PYTHONPATH="$(CURDIR)/$(TOOLS)" $(BIN)/python frontend/build.py

# Bytecode of the templates; a checksum tells the service which of them has changed since.
$(COMPILED): $(wildcard frontend/templates/* backend/hpn/web/pages/templates.py) $(ASSETS) | $(ENVIRONMENT)
	$(BIN)/python -c "from hpn.web.pages.templates import compile_all; compile_all()"
	@touch $@

# Debian's Chromium and its headless shell, which has the same engine at half the processor time; else an installed Chromium,
# else Playwright's own build. The last line of whichever fails says why.
browser: $(ENVIRONMENT)
	@command -v chromium-headless-shell && command -v chromium && exit 0; \
	get="apt-get install -q -y --no-install-recommends chromium chromium-headless-shell"; \
	if [ "$$(id -u)" = 0 ] && [ -f /etc/debian_version ] && { $$get || { apt-get update -q && $$get; }; }; then exit 0; fi; \
	for name in chromium chromium-browser google-chrome google-chrome-stable; do command -v $$name && exit 0; done; \
	$(BIN)/playwright install chromium || { echo "No Chromium found, and none could be installed" >&2; exit 1; }

# Recalculates the workbooks in the tests; like the browser, an installed one counts.
office:
	@for name in soffice libreoffice; do command -v $$name && exit 0; done; \
	if [ "$$(id -u)" = 0 ] && [ -f /etc/debian_version ] && apt-get update -q \
	    && apt-get install -q -y --no-install-recommends libreoffice-calc && command -v soffice; then exit 0; fi; \
	echo "No LibreOffice found, and none could be installed; install LibreOffice Calc" >&2; exit 1

# Runs the README's example.
curl:
	@command -v curl && exit 0; \
	if [ "$$(id -u)" = 0 ] && [ -f /etc/debian_version ] && apt-get update -q \
	    && apt-get install -q -y --no-install-recommends curl && command -v curl; then exit 0; fi; \
	echo "No curl found, and none could be installed" >&2; exit 1

# Compile the generated clients in Java and Kotlin for `make soak`.
java:
	@command -v javac && command -v mvn && exit 0; \
	if [ "$$(id -u)" = 0 ] && [ -f /etc/debian_version ] && apt-get update -q \
	    && apt-get install -q -y --no-install-recommends default-jdk-headless maven && command -v mvn; then exit 0; fi; \
	echo "No JDK and Maven found, and they could not be installed; install JDK 17 or newer and Maven" >&2; exit 1

# An independent check of PDF/UA for `make soak`: veraPDF's library from Maven Central, where Java and Maven are at hand.
pdfua:
	@command -v java && command -v mvn && $(MAKE) --no-print-directory $(VENV)/pdfua/.installed \
	    || echo "No Java, Maven or Maven Central: the reports are not checked against PDF/UA by veraPDF" >&2

$(VENV)/pdfua/.installed: tests/report/pdfua/pom.xml $(ENVIRONMENT)
	mvn --batch-mode --quiet --file $< dependency:copy-dependencies -DoutputDirectory="$(CURDIR)/$(@D)"
	@touch $@

# The reverse proxy of the compose file; envsubst fills in its configuration, openssl makes the tests' certificate.
nginx:
	@for name in nginx envsubst openssl; do command -v $$name || missing=1; done; [ -z "$$missing" ] && exit 0; \
	if [ "$$(id -u)" = 0 ] && [ -f /etc/debian_version ] && apt-get update -q \
	    && apt-get install -q -y --no-install-recommends nginx-light gettext-base openssl && command -v nginx; then exit 0; fi; \
	echo "No nginx, envsubst and openssl found, and they could not be installed" >&2; exit 1

# --- Upkeep -----------------------------------------------------------------------------------------------------------

COMPILE := pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-header --no-annotate --no-config \
	--no-emit-index-url --no-emit-find-links $(UPGRADE)

# Extras that a service is installed with.
SERVED := serve report aas mcp fleet postgres

# Texts of code and templates into the catalogues of translations; prints what is left to translate.
messages: $(ENVIRONMENT)
	$(BIN)/python -m tools.messages

lock: $(UV) | $(NODE)
	$(UV) $(COMPILE) pyproject.toml $(addprefix --extra ,$(SERVED)) --output-file requirements.lock
	$(UV) $(COMPILE) pyproject.toml --group dev --extra all --constraints requirements.lock --output-file requirements-dev.lock
	$(UV) $(COMPILE) --group build --output-file requirements-build.lock
	$(UV) $(COMPILE) --group node --output-file requirements-node.lock
	cd frontend && npm install --package-lock-only --loglevel=error
	@# npm copies each author's funding address into the lock; the project names no addresses
	$(BIN)/python -c "import json, pathlib; path = pathlib.Path('frontend/package-lock.json'); lock = json.loads(path.read_text()); \
	  [package.pop('funding', None) for package in lock['packages'].values()]; path.write_text(json.dumps(lock, indent=2) + '\n')"
	! grep -nE 'https?:|file:|find-links' requirements*.lock frontend/package-lock.json

# Licences of everything in the locks, into docs/licences.md.
licences: $(ENVIRONMENT)
	$(BIN)/python -m tools.supply.licences

# Packages of an installed service, as CycloneDX; the same locks give the same bytes.
sbom: $(ENVIRONMENT)
	$(BIN)/python -m tools.supply.sbom sbom.cdx.json

# The locks against known vulnerabilities: ends with 1 where there is one, 3 where no database can be asked.
audit: $(ENVIRONMENT) | $(NODE)
	$(BIN)/python -m tools.supply.audit

# The image and the compose file on a real engine: ends with 1 where a trial fails, 3 where no engine can be had.
.PHONY: containers
containers: $(ENVIRONMENT)
	$(BIN)/python -m tests.containers "$(ONLY)"

# Images are named by digest; this asks their registry for today's and writes them, all or none.
PINNED := docker-compose.yml backend/Dockerfile
digests:
	@set -e; script=; for image in $$(grep -ohE '[a-z]+:[A-Za-z0-9_.-]+@sha256:[0-9a-f]{64}' $(PINNED)); do \
	    tag=$${image%@*}; digest=$$(docker buildx imagetools inspect "$$tag" --format '{{.Manifest.Digest}}') \
	        || { echo "no digest of $$tag: this needs docker with buildx, and the registry" >&2; exit 1; }; \
	    echo "$$tag@$$digest"; script="$$script;s|$$image|$$tag@$$digest|"; \
	done; sed -i "$$script" $(PINNED)

# The proxy's certificate and key out of a folder such as /etc/letsencrypt/live/plm.example, checked; as root.
FROM ?= certificates
certificates:
	@sh backend/certificates.sh "$(FROM)"

# A backup takes the database's place, which is kept under its time; without the name of a backup there is a list of them.
NAME ?= $(filter %.dump,$(MAKECMDGOALS))
BACKUP := docker compose run --rm backup
restore:
	@docker compose version >/dev/null 2>&1 \
	    || { echo "docker compose is not here: docs/kubernetes.md says what takes its place" >&2; exit 1; }
	@[ -n "$(NAME)" ] || { echo "which backup? make restore NAME=… with one of these:" >&2; $(BACKUP) ls >&2; exit 2; }
	@running=$$(docker compose ps --quiet web) || exit 1; [ -z "$$running" ] \
	    || { echo "the service runs, and would go on saving what a restore loses: docker compose stop web" >&2; exit 1; }
	@$(BACKUP) sh /backup.sh unpack "$(NAME)"
	@docker compose run --rm --env HPN_DATABASE_URL=postgresql://hpn@db/hpn_restored web hpn database \
	    || $(BACKUP) sh /backup.sh give_up "the service can't use $(NAME)"
	@$(BACKUP) sh /backup.sh swap

%.dump: ;

clean:
	rm -rf $(VENV) $(MODULES) dist frontend/dist sbom.cdx.json .*_cache .hypothesis
