/* kirrou.c - figures 2 to 16 of Kirrou & Belhaq 2013: averaged theory (eqs 18-23), the paper's cubic model
 * (eq 3) and the true contact (eq 2, the published sign). Prints docs/img/papers/kirrou.csv. */
#include "tests/papers/tip/kirrou_paper.h"
#include "tests/papers/rows.h"

int main(void)
{
    rows_print_header();
    kirrou_draw_unmodulated();
    kirrou_draw_modulated();
    kirrou_draw_critical();
    kirrou_tell_numbers();
    return 0;
}
