// What all shaders share.
