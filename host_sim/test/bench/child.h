/* child.h - the controller's process: started in a group of
 * its own, its output kept, ended with all that it started. */
#ifndef HOST_SIM_CHILD_H
#define HOST_SIM_CHILD_H

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

enum { CHILD_TAIL = 160, CHILD_REASON = 320 };

struct child {
    pid_t pid;  /* 0: none, or it has ended */
    int output; /* all that it prints comes here; -1: none */
    FILE *copy; /* where the first 64 MB of it go, or NULL */
    int status; /* as of waitpid, once it has ended */
    bool ended;
    bool is_program;       /* the process is the controller itself; else a shell that runs a line */
    char line[CHILD_TAIL]; /* the last line that it printed */
    char part[CHILD_TAIL]; /* the one that it prints now */
    size_t n_part;
    size_t n_output; /* bytes that it has printed */
};

/* From now on this process is the parent of what its descendants leave behind. Children that it has by now
 * are none of a controller. */
void child_adopt(void);

/* Runs the command by a shell, in `folder`. False: why[CHILD_REASON]. */
bool child_start(struct child *c, const char *command, const char *folder, FILE *copy, char *why);

/* Takes what it has printed; true while it runs. */
bool child_look(struct child *c);

/* As child_look, and true while another process of its group runs: a shell may end before what it started. */
bool child_group_runs(struct child *c);

/* Takes what it prints while more comes at once, a tenth of a second at most. */
void child_listen(struct child *c);

/* Asks it and all of its group to end, by SIGTERM. */
void child_ask(struct child *c);

/* Ends what is left of it, and every process that it left behind. Returns how many those were. */
int child_end(struct child *c);

/* Ends what controllers of ended processes have left to this one, which must have called child_adopt. With
 * has_workers, children in this process's own group are workers and stay. Returns how many those were. */
int child_end_left(bool has_workers);

/* Its last line, for people, or nothing; and how much it printed where that is much. */
void child_describe_output(const struct child *c, char text[CHILD_REASON]);

/* How it ended, and what it printed, for people. */
void child_describe(const struct child *c, char text[CHILD_REASON]);

#endif
