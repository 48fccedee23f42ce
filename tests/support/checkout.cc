#include "tests/support/checkout.h"

namespace kerf::support {

std::string checkout() { return KERF_SOURCE_DIR; }

} // namespace kerf::support
