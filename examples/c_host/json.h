/* A reader of JSON texts: just what plan.json needs. */
#ifndef JSON_H
#define JSON_H

#include <stddef.h>

typedef enum { JSON_NULL, JSON_FALSE, JSON_TRUE, JSON_NUMBER, JSON_STRING, JSON_ARRAY, JSON_OBJECT } json_kind;

typedef struct json {
    json_kind kind;
    double number;             /* of JSON_NUMBER */
    const char *text;          /* of JSON_STRING */
    const char *name;          /* of a member of an object, else NULL */
    struct json *first, *next; /* of an array or object the first element; of an element the next */
} json;

/* Reads a text that ends with '\0' and is changed: strings stay in it, so it must outlive the result.
   NULL where it is no JSON; then *where is the place of the error. */
json *json_read(char *text, const char **where);

/* A member of an object by its name, or an element of a list by its place; _size: as a whole number from 0 on.
   They die() where there is none. */
const json *json_member(const json *object, const char *name);
const json *json_element(const json *list, size_t place);
size_t json_member_size(const json *object, const char *name);
size_t json_element_size(const json *list, size_t place);

/* A string; die() for anything else. */
const char *json_text(const json *value);

/* How many elements an array or object has. */
size_t json_count(const json *list);

void json_free(json *tree);

#endif
