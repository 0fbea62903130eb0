#include <dfield/dfield.hpp>
