/* Loads a field, places it over a ground, and asks how much of the sky some points see. C99.

       dfield bake models/cube_with_hole.obj -o cube.dfield
       hello_lookup cube.dfield */
#include <dfield/dfield.h>
#include <math.h>
#include <stdio.h>

enum { kReceivers = 9 };

static int failed(dfield_status status, const char* what) {
    if (status == DFIELD_OK) return 0;
    fprintf(stderr, "%s: %s: %s\n", what, dfield_status_name(status), dfield_error_message());
    return 1;
}

int main(int argc, char** argv) {
    /* Column-major, as in glTF; the last column is the translation, filled in below. */
    float object_to_world[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const float ground[4] = {0, 1, 0, 0}; /* the plane y = 0 */
    float positions[kReceivers][3], normals[kReceivers][3], visibility[kReceivers];
    dfield_context* context = NULL;
    dfield_field* field = NULL;
    dfield_scene* scene = NULL;
    dfield_ao* ao = NULL;
    dfield_instance instance;
    dfield_field_info info;
    dfield_ao_desc settings;
    dfield_receivers receivers = {0};
    int i;

    if (argc != 2) {
        fprintf(stderr, "usage: hello_lookup FILE.dfield\n");
        return 2;
    }
    if (failed(dfield_context_create(NULL, &context), "context") ||
        failed(dfield_field_load_file(context, argv[1], &field), "field") ||
        failed(dfield_field_get_info(field, &info), "info"))
        return 1;
    printf("radius %g, %llu bytes in memory\n", info.radius, (unsigned long long)info.memory_bytes);

    /* The object stands on the ground, its middle over the origin. */
    object_to_world[12] = -info.centre[0];
    object_to_world[13] = -info.bounds_min[1];
    object_to_world[14] = -info.centre[2];
    if (failed(dfield_scene_create(context, &scene), "scene") ||
        failed(dfield_scene_add_instance(scene, field, object_to_world, &instance), "instance") ||
        failed(dfield_scene_set_ground(scene, ground), "ground"))
        return 1;
    dfield_field_release(field); /* the scene keeps it */

    /* A row of points on the ground, from beside the object away from it, that look up. */
    for (i = 0; i < kReceivers; ++i) {
        positions[i][0] = info.radius * (0.5f + 0.5f * (float)i);
        positions[i][1] = positions[i][2] = 0;
        normals[i][0] = normals[i][2] = 0;
        normals[i][1] = 1;
    }
    receivers.count = kReceivers;
    receivers.positions = positions[0];
    receivers.normals = normals[0];

    dfield_ao_desc_init(&settings); /* 256 rays around each normal */
    if (!(info.kinds & (1u << DFIELD_KIND_MAPS | 1u << DFIELD_KIND_LINES))) {
        settings.sampling = DFIELD_SAMPLING_SHARED; /* all that direction maps can answer */
        settings.ray_count = 512;
    }
    if (failed(dfield_ao_create(context, &settings, &ao), "settings") ||
        failed(dfield_scene_visibility(scene, ao, &receivers, visibility, 0), "visibility"))
        return 1;
    for (i = 0; i < kReceivers; ++i)
        printf("%5.2f radii away: sees %5.1f %% of the sky\n", positions[i][0] / info.radius,
               100 * visibility[i]);

    dfield_ao_release(ao);
    dfield_scene_release(scene);
    dfield_context_release(context);
    return visibility[kReceivers - 1] > visibility[0] ? 0 : 1; /* farther away, more sky */
}
