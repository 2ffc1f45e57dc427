/* ctype.h - declarations of C99, see math.h beside it. */
#ifndef LINKER_HOSTED_CTYPE_H
#define LINKER_HOSTED_CTYPE_H

int isspace(int c);
int isdigit(int c);
int isalnum(int c);
int tolower(int c);

#endif
