/* A reader for JSON with only what plan.json needs. */
#ifndef JSON_H
#define JSON_H

#include <stddef.h>

typedef enum { JSON_NULL, JSON_FALSE, JSON_TRUE, JSON_NUMBER, JSON_STRING, JSON_ARRAY, JSON_OBJECT } json_kind;

typedef struct json {
    json_kind kind;
    double number;             /* of JSON_NUMBER */
    const char *text;          /* of JSON_STRING */
    const char *name;          /* of a member of an object, otherwise NULL */
    struct json *first, *next; /* the first element of an array or object; the next element of the same one */
} json;

/* Reads a text that ends with '\0'. The text is changed and must outlive the result, because strings stay in it.
   Returns NULL if it is not JSON; *where is then the place of the error. */
json *json_read(char *text, const char **where);

/* A member of an object by its name, or an element of a list by its index; _size returns it as a whole number >= 0.
   They die() if there is none. */
const json *json_member(const json *object, const char *name);
const json *json_element(const json *list, size_t place);
size_t json_member_size(const json *object, const char *name);
size_t json_element_size(const json *list, size_t place);

/* A string; die() for anything else. */
const char *json_text(const json *value);

/* The number of elements of an array or object. */
size_t json_count(const json *list);

void json_free(json *tree);

#endif
