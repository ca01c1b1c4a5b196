"""The Blender view: the only folder that imports bpy, always in a worker process of its own."""
