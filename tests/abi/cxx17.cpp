#include <dfield/dfield.h>
