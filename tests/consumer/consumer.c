/* C99: loads a field from memory, shoots a bundle of rays at one instance of it and one ray away from it. */
#include <dfield/dfield.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { kGrid = 16, kRays = kGrid * kGrid };

static void require(int condition, const char* what) {
    if (!condition) {
        fprintf(stderr, "consumer_c: %s: %s\n", what, dfield_error_message());
        exit(1);
    }
}

static void* read_file(const char* path, size_t* size) {
    FILE* file = fopen(path, "rb");
    void* bytes = NULL;
    long length = 0;
    require(file != NULL, "cannot open the file");
    require(fseek(file, 0, SEEK_END) == 0 && (length = ftell(file)) > 0, "cannot read the file");
    rewind(file);
    *size = (size_t)length;
    bytes = malloc(*size);
    require(bytes != NULL && fread(bytes, 1, *size, file) == *size, "cannot read the file");
    fclose(file);
    return bytes;
}

int main(int argc, char** argv) {
    const float scale = 2.0f;
    float transform[16] = {0};
    float origins[kRays][3], directions[kRays][3], distances[kRays];
    dfield_instance hit_instances[kRays];
    dfield_context* context = NULL;
    dfield_field* field = NULL;
    dfield_scene* scene = NULL;
    dfield_instance instance = DFIELD_NO_INSTANCE;
    dfield_field_info info;
    dfield_rays rays = {0};
    dfield_hits hits = {0};
    size_t size = 0;
    void* bytes = NULL;
    float radius = 0.0f;
    int hit_count = 0;

    require(argc == 2, "usage: consumer_c FILE.dfield");
    bytes = read_file(argv[1], &size);
    require(dfield_context_create(NULL, &context) == DFIELD_OK, "context");
    require(dfield_field_load_memory(context, bytes, size, &field) == DFIELD_OK, "field");
    free(bytes);
    require(dfield_field_get_info(field, &info) == DFIELD_OK && info.radius > 0.0f, "info");

    /* Twice as large, its centre at the origin of the world. */
    for (int axis = 0; axis < 3; ++axis) {
        transform[5 * axis] = scale;
        transform[12 + axis] = -scale * info.centre[axis];
    }
    transform[15] = 1.0f;
    radius = scale * info.radius;
    require(dfield_scene_create(context, &scene) == DFIELD_OK, "scene");
    require(dfield_scene_add_instance(scene, field, transform, &instance) == DFIELD_OK, "instance");
    dfield_field_release(field); /* the scene keeps it */

    /* A grid of parallel rays over the whole sphere from 3 radii away; the last one turned round. */
    for (int i = 0; i < kRays; ++i) {
        origins[i][0] = radius * ((2 * (i % kGrid) + 1) / (float)kGrid - 1.0f);
        origins[i][1] = radius * ((2 * (i / kGrid) + 1) / (float)kGrid - 1.0f);
        origins[i][2] = 3.0f * radius;
        directions[i][0] = directions[i][1] = 0.0f;
        directions[i][2] = i == kRays - 1 ? 1.0f : -1.0f;
    }
    rays.count = kRays;
    rays.origins = &origins[0][0];
    rays.directions = &directions[0][0];
    hits.distances = distances;
    hits.instances = hit_instances;
    require(dfield_scene_trace(scene, &rays, &hits) == DFIELD_OK, "trace");
    for (int i = 0; i < kRays; ++i) {
        if (isinf(distances[i])) {
            require(hit_instances[i] == DFIELD_NO_INSTANCE, "a miss hits no instance");
            continue;
        }
        ++hit_count;
        require(hit_instances[i] == instance, "a hit is on the only instance");
        require(distances[i] > 1.99f * radius && distances[i] < 4.01f * radius,
                "a hit lies within the sphere");
    }
    require(hit_count > 0, "some ray hits the object");
    require(isinf(distances[kRays - 1]), "a ray that flies away misses");
    printf("consumer_c: %d of %d rays hit\n", hit_count, kRays);

    dfield_scene_release(scene);
    dfield_context_release(context);
    return 0;
}
