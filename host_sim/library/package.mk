# package.mk - the product as a tarball, as Debian packages, and for Python.
TARBALL = $(BUILD)/contactplant-$(VERSION).tar.gz

# Equal bytes for equal commits.
dist: ## build/contactplant-VERSION.tar.gz: the last commit, which builds and passes its tests anywhere
	@[ -e .git ] || { echo "make dist: there is no git repository here; its tarball is what was unpacked" >&2; exit 1; }
	@[ -z "$$(git status --porcelain)" ] || echo "make dist: changes that are not committed are left out" >&2
	@mkdir -p $(BUILD)
	@git archive --format=tar --prefix=contactplant-$(VERSION)/ HEAD | gzip -9n >$(TARBALL)
	@echo "$(TARBALL)"

deb: all ## Debian packages of this build in build/deb: program, library, header; needs dpkg-dev
	@ABI=$(ABI) VERSION=$(VERSION) POINTER=$(POINTER) host_sim/library/deb.sh $(BUILD)

wheel: lib ## a wheel of contactplant.py with the library in build/wheel, for pip; needs python3 alone
	@$(PYTHON) host_sim/python/wheel.py $(BUILD) $(CC) $(OPT) $(EXTRA)

.PHONY: dist deb wheel
