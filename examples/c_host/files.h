/* Files, and what to do where they are not as expected: say so and end the program. */
#ifndef FILES_H
#define FILES_H

#include <stddef.h>

enum { LONGEST_PATH = 4096 };

/* Prints a message as printf does, and ends the program with exit code 1. */
void die(const char *format, ...);

/* Memory of zeros. */
void *take(size_t bytes);

int has_file(const char *folder, const char *name);

/* Reads a file that has exactly so many bytes. */
void read_exactly(const char *folder, const char *name, void *to, size_t bytes);

/* Reads a whole file, with '\0' behind it; free() gives it back. */
char *read_text(const char *folder, const char *name);

void write_file(const char *folder, const char *name, const void *from, size_t bytes);

#endif
