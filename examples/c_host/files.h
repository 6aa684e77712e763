/* Reads and writes files. If a file is not as expected, these functions print a message and end the program. */
#ifndef FILES_H
#define FILES_H

#include <stddef.h>

enum { LONGEST_PATH = 4096 };

/* Prints a message as printf does, and ends the program with exit code 1. */
void die(const char *format, ...);

/* Allocates memory and fills it with zeros. */
void *take(size_t bytes);

int has_file(const char *folder, const char *name);

/* Reads a file that must have exactly this many bytes. */
void read_exactly(const char *folder, const char *name, void *to, size_t bytes);

/* Reads a whole file and adds '\0' at its end; free() the result. */
char *read_text(const char *folder, const char *name);

void write_file(const char *folder, const char *name, const void *from, size_t bytes);

#endif
