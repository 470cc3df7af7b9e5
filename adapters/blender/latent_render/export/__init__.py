"""From Blender's evaluated scene to a scene of pbrt-v4 with meshes in PLY files."""
