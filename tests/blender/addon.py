"""Uses the exporter as an installed add-on, in Blender: blender SCENE --python addon.py -- POCKETRAY.PY PROGRAM OUT.pray"""
import os
import sys
import traceback

import bpy

source, program, out = sys.argv[-3:]


def counts():
    kinds = (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.scenes, bpy.data.cameras, bpy.data.images)
    return [len(kind) for kind in kinds] + [bpy.context.scene.frame_current]


def refusal(**options):
    try:
        bpy.ops.export_scene.pocketray(**options)
    except RuntimeError as error:
        return str(error)
    raise AssertionError("not refused")


def main():
    bpy.ops.preferences.addon_install(filepath=source)
    bpy.ops.preferences.addon_enable(module="pocketray")
    preferences = bpy.context.preferences.addons["pocketray"].preferences
    bpy.context.scene.frame_set(2)
    before = counts()
    preferences.program = "/nowhere/pocketray"
    assert "is not found" in refusal(filepath=out)
    preferences.program = program
    assert "must end in .pray" in refusal(filepath=out + ".glb")
    assert bpy.ops.export_scene.pocketray(filepath=out) == {"FINISHED"}
    assert os.path.getsize(out) > 1000
    whole = os.path.getsize(out)
    light = next(item for item in bpy.data.objects if item.type == "LIGHT")
    for item in bpy.data.objects:
        item.select_set(item == light or item.type == "CAMERA")
    assert bpy.ops.export_scene.pocketray(filepath=out, objects="SELECTED", compressed=True) == {"FINISHED"}
    assert os.path.getsize(out) < whole
    assert bpy.ops.export_scene.pocketray(filepath=out, objects="VISIBLE", radiosity=True) == {"FINISHED"}
    assert os.path.getsize(out) > whole
    assert counts() == before, f"{counts()} instead of {before}"
    bpy.ops.preferences.addon_disable(module="pocketray")
    assert not hasattr(bpy.types, "EXPORT_SCENE_OT_pocketray")


try:
    main()
except Exception:
    traceback.print_exc()
    sys.exit(1)
