/* A plain C99 program: header and library are of one version, errors arrive as status and text, null is
 * released. */
#include <dfield/dfield.h>
#include <stdio.h>
#include <string.h>

static int failures = 0;

static void expect(int condition, const char* what) {
    if (!condition) {
        fprintf(stderr, "failed: %s\n", what);
        ++failures;
    }
}

int main(void) {
    dfield_context* context = NULL;
    dfield_field* field = NULL;
    const char junk[] =
        "this is no displacement field, only text long enough to hold a header of one if it were";

    expect(
        dfield_version() == 10000 * DFIELD_VERSION_MAJOR + 100 * DFIELD_VERSION_MINOR + DFIELD_VERSION_PATCH,
        "dfield_version() is the header's");
    expect(dfield_context_create(NULL, &context) == DFIELD_OK && context != NULL, "a context without hooks");
    expect(dfield_context_create(NULL, NULL) == DFIELD_INVALID_ARGUMENT, "a null result is refused");
    expect(dfield_field_load_memory(context, junk, sizeof junk, &field) == DFIELD_FORMAT_ERROR,
           "junk is refused");
    expect(field == NULL, "a refused field leaves the result alone");
    expect(strlen(dfield_error_message()) > 0, "a failure has a message");
    expect(dfield_field_load_file(context, "no such folder/no such file.dfield", &field) == DFIELD_FILE_ERROR,
           "a missing file is a file error");
    expect(strstr(dfield_error_message(), "no such file.dfield") != NULL, "the message names the file");

    dfield_field_release(NULL);
    dfield_scene_release(NULL);
    dfield_ao_release(NULL);
    dfield_context_release(NULL);
    dfield_context_release(context);
    return failures == 0 ? 0 : 1;
}
