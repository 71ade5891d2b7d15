// Draws a volume's box, whose fragments trace rays.
in vec3 position;  // index coordinates
uniform mat4 indexToClip;

void main() { gl_Position = indexToClip * vec4(position, 1.0); }
