/* What the test programs share. */
#ifndef COMMON_H
#define COMMON_H
#include <asperity.h>
/* Twice, as through two headers of a program. */
#include <asperity.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Ends the program when something does not hold, with the place and the library's sentence. */
#define MUST(holds)                                                                                                    \
    do {                                                                                                               \
        if (!(holds)) {                                                                                                \
            fprintf(stderr, "%s:%d: %s does not hold; the library says: \"%s\"\n", __FILE__, __LINE__, #holds,         \
                    asp_last_error());                                                                                 \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (0)

/* A file as text; the caller frees it. */
static inline char *slurp(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    if (!file) {
        perror(path);
        exit(1);
    }
    fseek(file, 0, SEEK_END);
    long length = ftell(file);
    rewind(file);
    char *text = (char *)malloc((size_t)length + 1);
    if (fread(text, 1, (size_t)length, file) != (size_t)length) {
        perror(path);
        exit(1);
    }
    text[length] = 0;
    fclose(file);
    if (size)
        *size = (size_t)length;
    return text;
}
#endif
