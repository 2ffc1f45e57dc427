/* work_pieces.h - small pieces of work whose instructions are counted: on the host by callgrind
 * (tests/bench/cost/instructions.c), on boards by a clock that counts them (tests/boards/board_cost.c). */
#ifndef TESTS_WORK_PIECES_H
#define TESTS_WORK_PIECES_H

enum { WORK_PIECES = 22, WORK_CALLS = 2000 };

/* Set-up and warm-up lie in `setup`; `once` is a function `once_NAME`, found by that name. */
struct work_piece {
    const char *name;
    void (*setup)(void), (*once)(void);
};
extern const struct work_piece work_piece[WORK_PIECES];

/* Makes ready for calls of work_piece[i].once, and checks that the last one did what its name says. */
void work_setup(int i);
void work_check(int i);

/* The first thing that was not what it should be, or NULL. */
extern const char *work_fault;

#endif
