// C++17 through the wrapper: ambient occlusion of receivers that face a field, lie beside it, and face away
// from it.
#include <dfield/dfield.hpp>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

void require(bool condition, const char* what) {
    if (!condition) throw std::runtime_error(what);
}

void run(const char* path) {
    const dfield::Context context;
    const dfield::Field field = dfield::Field::load(context, path);
    const dfield_field_info info = field.info();
    dfield::Scene scene(context);
    const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const dfield_instance instance = scene.add(field, identity);

    // Just outside the sphere: looking at it, looking away from it; far away: looking at it.
    const float below = info.centre[1] - 1.2f * info.radius;
    const std::vector<float> positions = {
        info.centre[0], below,          info.centre[2], info.centre[0],
        below,          info.centre[2], info.centre[0], info.centre[1] - 100.0f * info.radius,
        info.centre[2]};
    const std::vector<float> normals = {0, 1, 0, 0, -1, 0, 0, 1, 0};
    dfield_receivers receivers{};
    receivers.count = 3;
    receivers.positions = positions.data();
    receivers.normals = normals.data();

    const dfield::Ao ao(context);
    std::vector<float> visibility(3, -1.0f);
    scene.visibility(ao, receivers, visibility.data());
    std::cout << "consumer_cpp: visibility " << visibility[0] << ' ' << visibility[1] << ' ' << visibility[2]
              << '\n';
    require(visibility[0] > 0.0f && visibility[0] < 0.99f, "the object shadows who faces it from near");
    require(visibility[1] == 1.0f, "it does not shadow who faces away");
    require(visibility[2] > visibility[0], "it shadows less from far");

    scene.remove(instance);
    scene.visibility(ao, receivers, visibility.data());
    require(visibility[0] == 1.0f, "an empty scene shadows nobody");

    try {
        dfield::Field::load(context, "no such file.dfield");
    } catch (const dfield::Exception& error) {
        require(error.status() == DFIELD_FILE_ERROR, "a missing file is a file error");
        require(std::string(error.what()).find("no such file") != std::string::npos,
                "the message names the file");
        return;
    }
    require(false, "a missing file throws");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        require(argc == 2, "usage: consumer_cpp FILE.dfield");
        run(argv[1]);
    } catch (const std::exception& error) {
        std::cerr << "consumer_cpp: " << error.what() << '\n';
        return 1;
    }
}
