#include "app/commit.hpp"

namespace tarn::app {

const char* built_commit() { return TARN_COMMIT; }

} // namespace tarn::app
