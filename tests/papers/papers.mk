# papers.mk - `make papers`: the charts of docs/PAPERS.md. Each program prints one CSV to docs/papers and, to
# build/papers/NAME.txt, the numbers of its text. Four minutes of computing time, side by side; needs gnuplot.
PAPERS      := bichri kirrou nayak shaft maps
PAPERS_WITH := $(call obj,$(PAPER_SRC) $(addprefix tests/,papers/rows.c paper.c mathieu.c bench/classical.c exact.c) $(HOST_PARTS))
# The helpers name their failures through tests/test.h, whose runner is not linked here.
PAPERS_WITH += $(BUILD)/tests/papers/failures.o
$(BUILD)/papers_kirrou: $(call obj,$(wildcard tests/papers/kirrou_*.c))
$(BUILD)/papers_%: $(BUILD)/tests/papers/%.o $(PAPERS_WITH) $(LIB)
	@$(CC) $(CFLAGS) $(filter %.o,$^) $(LIB) -lm -o $@
papers-%: $(BUILD)/papers_%
	@mkdir -p build/papers
	@echo "  docs/papers/$*.csv"
	@$(BUILD)/papers_$* >docs/papers/$*.csv 2>build/papers/$*.txt
	@gnuplot -e "csv='docs/papers/$*.csv'; out='docs/papers'" tests/papers/style.gp tests/papers/$*.gp 2>build/papers/$*.log || \
	    { cat build/papers/$*.log; exit 1; }
# gnuplot opens a group for every change of pen, leaves most of them empty, and names SVG's own defaults in each.
	@sed -z -i 's/<g [^>]*>\n<\/g>\n//g; s/ stroke-linecap="butt" stroke-linejoin="miter"//g' docs/papers/$**.svg
papers:
	@$(MAKE) -s -j2 $(PAPERS:%=papers-%)
.PHONY: papers
