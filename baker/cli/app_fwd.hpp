// The parser of CLI11 by name: who adds options to it includes arguments.hpp, which takes long to compile.
#pragma once

namespace CLI {
class App;
}
