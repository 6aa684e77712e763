#include "files.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void die(const char *format, ...) {
    va_list values;
    va_start(values, format);
    fputs("svgf_host: ", stderr);
    vfprintf(stderr, format, values);
    fputc('\n', stderr);
    va_end(values);
    exit(1);
}

void *take(size_t bytes) {
    void *memory = calloc(bytes ? bytes : 1, 1);
    if (!memory) die("no room for %lu bytes", (unsigned long)bytes);
    return memory;
}

static void join(char *path, const char *folder, const char *name) {
    const int length = snprintf(path, LONGEST_PATH, "%s/%s", folder, name);
    if (length < 0 || length >= LONGEST_PATH) die("a path is longer than %d characters", LONGEST_PATH - 1);
}

int has_file(const char *folder, const char *name) {
    char path[LONGEST_PATH];
    join(path, folder, name);
    FILE *file = fopen(path, "rb");
    if (file) fclose(file);
    return file != NULL;
}

void read_exactly(const char *folder, const char *name, void *to, size_t bytes) {
    char path[LONGEST_PATH];
    join(path, folder, name);
    FILE *file = fopen(path, "rb");
    if (!file) die("%s: cannot be read", path);
    if (fread(to, 1, bytes, file) != bytes || fgetc(file) != EOF)
        die("%s: expected %lu bytes", path, (unsigned long)bytes);
    fclose(file);
}

char *read_text(const char *folder, const char *name) {
    char path[LONGEST_PATH];
    join(path, folder, name);
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END)) die("%s: cannot be read", path);
    const long bytes = ftell(file);
    fclose(file);
    char *text = take((size_t)bytes + 1);
    read_exactly(folder, name, text, (size_t)bytes);
    return text;
}

void write_file(const char *folder, const char *name, const void *from, size_t bytes) {
    char path[LONGEST_PATH];
    join(path, folder, name);
    FILE *file = fopen(path, "wb");
    if (!file) die("%s: cannot be written", path);
    if (fwrite(from, 1, bytes, file) != bytes || fclose(file)) die("%s: cannot be written whole", path);
}
