/* completion.h - names for the completion of words by bash. */
#ifndef HOST_SIM_COMPLETION_H
#define HOST_SIM_COMPLETION_H

/* Prints a part of bash's function: $scenes, $causes, and the first cases for the word before the one to
 * complete, whose names go into $words. The caller adds others, and the esac. */
void completion_print_names(void);

#endif
