#include "json.h"

#include <stdlib.h>
#include <string.h>

#include "files.h"

#define LARGEST 9007199254740992.0 /* up to this, a double holds every whole number */
enum { DEEPEST = 64 };

static json *read_value(char **at, int depth);

static void skip_space(char **at) { *at += strspn(*at, " \t\r\n"); }

/* Reads a string in place, and removes its quotes and escapes. Plans use \u only for ASCII. */
static const char *read_string(char **at) {
    static const char codes[] = "\"\\/bfnrt", values[] = "\"\\/\b\f\n\r\t";
    char *from = *at, *to, *begin;
    if (*from++ != '"') return NULL;
    for (begin = to = from; *from != '"'; ++from) {
        if ((unsigned char)*from < ' ') return NULL;
        if (*from == '\\') {
            const char *code = *++from ? strchr(codes, *from) : NULL;
            if (code) {
                *to++ = values[code - codes];
            } else {
                char digits[5] = {0}, *end;
                if (*from != 'u') return NULL;
                strncpy(digits, from + 1, 4);
                const long value = strtol(digits, &end, 16);
                if (end != digits + 4 || value < 1 || value > 127) return NULL;
                *to++ = (char)value;
                from += 4;
            }
        } else {
            *to++ = *from;
        }
    }
    *at = from + 1;
    *to = '\0';
    return begin;
}

/* Reads the elements of an array, or the members of an object with their names. */
static int read_elements(char **at, json *list, int depth) {
    const char end = list->kind == JSON_ARRAY ? ']' : '}';
    json **next = &list->first;
    ++*at;
    skip_space(at);
    if (**at == end) return ++*at, 1;
    for (;;) {
        const char *name = NULL;
        skip_space(at);
        if (list->kind == JSON_OBJECT) {
            if (!(name = read_string(at))) return 0;
            skip_space(at);
            if (**at != ':') return 0;
            ++*at;
        }
        if (!(*next = read_value(at, depth + 1))) return 0;
        (*next)->name = name;
        next = &(*next)->next;
        skip_space(at);
        const char mark = **at;
        if (mark != ',' && mark != end) return 0;
        ++*at;
        if (mark == end) return 1;
    }
}

static int read_word(char **at, const char *word) {
    const size_t length = strlen(word);
    if (strncmp(*at, word, length) != 0) return 0;
    *at += length;
    return 1;
}

static int read_number(char **at, double *number) {
    char *end;
    if (!strchr("-0123456789", **at) || !**at) return 0;
    *number = strtod(*at, &end); /* this uses the C locale, because the program never calls setlocale */
    if (end == *at) return 0;
    *at = end;
    return 1;
}

static json *read_value(char **at, int depth) {
    json *value = calloc(1, sizeof *value);
    int is_read = 0;
    if (!value) return NULL;
    skip_space(at);
    if (**at == '[' || **at == '{') {
        value->kind = **at == '[' ? JSON_ARRAY : JSON_OBJECT;
        is_read = depth < DEEPEST && read_elements(at, value, depth);
    } else if (**at == '"') {
        value->kind = JSON_STRING;
        is_read = (value->text = read_string(at)) != NULL;
    } else if (read_word(at, "true")) {
        value->kind = JSON_TRUE, is_read = 1;
    } else if (read_word(at, "false")) {
        value->kind = JSON_FALSE, is_read = 1;
    } else if (read_word(at, "null")) {
        is_read = 1;
    } else {
        value->kind = JSON_NUMBER;
        is_read = read_number(at, &value->number);
    }
    if (is_read) return value;
    json_free(value);
    return NULL;
}

json *json_read(char *text, const char **where) {
    char *at = text;
    json *value = read_value(&at, 0);
    skip_space(&at);
    *where = at;
    if (value && !*at) return value;
    json_free(value);
    return NULL;
}

const json *json_member(const json *object, const char *name) {
    for (const json *each = object->first; each && object->kind == JSON_OBJECT; each = each->next)
        if (strcmp(each->name, name) == 0) return each;
    die("JSON: expected a member named %s, found none", name);
    return NULL;
}

const json *json_element(const json *list, size_t place) {
    const json *found = list->first;
    for (size_t i = 0; found && i < place; ++i) found = found->next;
    if (!found)
        die("JSON: expected at least %lu elements of %s", (unsigned long)place + 1, list->name ? list->name : "a list");
    return found;
}

static size_t size(const json *value) {
    if (value->kind != JSON_NUMBER || !(value->number >= 0 && value->number < LARGEST)) {
        die("JSON: expected a number from 0 on%s%s", value->name ? " as " : "", value->name ? value->name : "");
    }
    return (size_t)value->number;
}

size_t json_member_size(const json *object, const char *name) { return size(json_member(object, name)); }

size_t json_element_size(const json *list, size_t place) { return size(json_element(list, place)); }

const char *json_text(const json *value) {
    if (value->kind != JSON_STRING)
        die("JSON: expected a text%s%s", value->name ? " as " : "", value->name ? value->name : "");
    return value->text;
}

size_t json_count(const json *list) {
    size_t count = 0;
    for (const json *each = list->first; each; each = each->next) ++count;
    return count;
}

void json_free(json *tree) {
    while (tree) {
        json *next = tree->next;
        json_free(tree->first);
        free(tree);
        tree = next;
    }
}
