# papers.mk - `make papers`: the charts of docs/papers/figures.md. Each program prints one CSV to docs/img/papers and, to
# build/papers/NAME.txt, the numbers of its text; its charts are docs/img/papers/NAME.svg or NAME-*.svg. Needs gnuplot.
# The long ones first: they run side by side.
PAPERS      := maps shaft_numbers shaft_isolas kirrou shaft_soft shaft_hard shaft_edge bichri shaft_motion nayak shaft_linear
PAPERS_WITH := $(call obj,$(PAPER_SRC) $(call test_src,rows paper mathieu classical exact))
# The helpers name their failures through tests/unit/test.h, whose runner is not linked here.
PAPERS_WITH += $(BUILD)/tests/papers/failures.o
$(BUILD)/papers_nayak: $(call obj,$(call test_src,nayak_forced nayak_numbers))
$(BUILD)/papers_kirrou: $(call obj,$(wildcard tests/papers/tip/kirrou_*.c))
$(addprefix $(BUILD)/papers_,maps $(filter shaft%,$(PAPERS))): $(call obj,tests/papers/response.c tests/papers/history.c)
$(foreach name,$(PAPERS),$(eval $(BUILD)/papers_$(name): $(call obj,$(call test_src,$(name)))))
$(PAPERS:%=$(BUILD)/papers_%): $(BUILD)/papers_%: $(PAPERS_WITH) $(HOST_LIB) $(LIB)
	@$(CC) $(CFLAGS) $(filter %.o,$^) $(filter %.a,$^) -lm -o $@
papers-%: $(BUILD)/papers_%
	@mkdir -p build/papers
	@echo "  docs/img/papers/$*.csv ..."
	@$(call print_rows,$(BUILD)/papers_$*,docs/img/papers/$*.csv) 2>build/papers/$*.txt
	@(cd $(WHERE) && gnuplot -e "csv='docs/img/papers/$*.csv'; out='docs/img/papers'" $(CURDIR)/tests/papers/style.gp $(CURDIR)/$(wildcard tests/papers/*/$*.gp)) \
	    2>build/papers/$*.log || { cat build/papers/$*.log; exit 1; }
# gnuplot opens a group for every change of pen, leaves most of them empty, and names SVG's own defaults in each.
	@sed -z -i 's/<g [^>]*>\n<\/g>\n//g; s/ stroke-linecap="butt" stroke-linejoin="miter"//g' $$(ls $(WHERE)/docs/img/papers/$*.svg $(WHERE)/docs/img/papers/$*-*.svg 2>/dev/null)
	@echo "  docs/img/papers/$*.csv done"
# Numbers only.
papers-shaft_numbers: $(BUILD)/papers_shaft_numbers
	@mkdir -p build/papers
	@$(if $(SHORT),tests/bench/first_rows.sh $(BUILD)/papers_shaft_numbers -,$(BUILD)/papers_shaft_numbers 2>build/papers/shaft_numbers.txt)
papers: ## the figures of the four papers, redrawn beside the true contact: docs/papers/figures.md (needs gnuplot)
	@$(MAKE) -s $(PAPERS:%=papers-%)
.PHONY: papers
