#pragma once
/// @file gl.hpp  The only place that includes a GL header. libglvnd's libOpenGL exports the whole
///               4.5 core API, so no loader library is needed.
#define GL_GLEXT_PROTOTYPES 1
#include <GL/glcorearb.h>
