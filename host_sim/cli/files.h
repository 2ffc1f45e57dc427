/* files.h - the files of a command line: no output is an input of the same line, or another output.
 *
 * Files are compared by what they are, not by their names: through links, with ./ in front, and by folder and
 * name where there is no file yet. options_parse tells all that the tables of options know, before anything
 * is done; what a command finds named in a file it tells by files_reads. Every file of the program that is
 * written is opened here.
 *
 * A file is written where it is, never renamed over: a device or a pipe stays one, and a link stays a link.
 * One that another process writes, as the log of a running plant, is refused. Standard output and standard
 * error are outputs of every line where they go into a file. */
#ifndef HOST_SIM_FILES_H
#define HOST_SIM_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { FILES_REASON = 512 };

/* A new command line: nothing is known of it. Before the first one everything may be written. */
void files_begin(void);

/* An output of this command line: the value `path` of --option, which stays where it is, or with "" a word. A
 * folder is an output with all files directly in it. False, and nothing is taken: why says what to do. */
bool files_take(const char *option, const char *path, bool folder, char why[FILES_REASON]);

/* The file `name` that will be written into a folder of files_take: the same, before the work is done. */
bool files_take_in(const char *folder, const char *name, char why[FILES_REASON]);

/* An input of this command line, before it is read. False where it is an output, too: why says that it is
 * `what`, say "the scene itself". */
bool files_reads(const char *path, const char *what, char why[FILES_REASON]);

/* Whether a file may be written: it is no input. For outputs that are not opened here. */
bool files_may_write(const char *path);

/* Opens an output to write into it as it comes. NULL with errno. It must be one of files_take. */
FILE *files_create(const char *path);

/* Opens an output that is kept in memory until files_finish. Then the file is whole, or as it was. */
FILE *files_compose(const char *path);

/* Opens an output that goes on: to read and write, made where it is missing. NULL with errno. */
FILE *files_resume(const char *path);

/* Makes a folder and those above it, where they are missing. False with errno. */
bool files_make_folder(const char *path);

/* Makes an empty file without a name in $TMPDIR, or /tmp, which this process finds at the path until it
 * closes the file that is returned. Whatever ends the process, nothing is left. -1 with errno. */
int files_make_temporary(char *path, size_t size);

/* Ends what files_create and files_compose began; standard output is only flushed. good: all of it was put,
 * so that what was composed is to be written. True when the file is complete; else errno says why not. */
bool files_finish(FILE *f, bool good);

/* Why a write to f failed whose errno is lost: the next one fails for the same reason. */
int files_find_cause(FILE *f);

/* The errno of a write that failed, in words, and what to do about it. */
const char *files_unwritten(int error);

#endif
