#include <dfield/threads.hpp>
