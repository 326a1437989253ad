#pragma once
/// @file commit.hpp  Which tarn this is, for measurements.

namespace tarn::app {

/// The commit that was built, as git describes it; "unknown" outside a checkout.
const char* built_commit();

} // namespace tarn::app
