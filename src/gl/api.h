#pragma once

/// The functions of OpenGL as libOSMesa exports them. Only the .cc files of this room include this.

#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
