// Lights a level that Relume exported by its lightmap (Unity 2022.3 or newer, linear colour space).
//
// 1. Copy the exported folder into Assets. scene.glb needs an importer of glTF files: package com.unity.cloud.gltfast.
// 2. Set lightmap.exr to texture type Default, sRGB off, compression None or BC6H, wrap mode Clamp, mipmaps off.
// 3. Project Settings: Player > Lightmap Encoding "High Quality"; Graphics > Lightmap Modes "Custom" with "Baked
//    Non-Directional". Lighting window: no ambient light, and no reflections of the environment.
// 4. Put scene.glb into a scene, this component on its root, and lightmap.exr into the component's field.
//
// The lightmap has lighting in cd/m^2; Exposure brings it to the screen. The level's emission is there already, and
// ends at white, as glTFast knows no brighter one.
using System.Collections.Generic;
using UnityEngine;

[ExecuteAlways]
public class RelumeLightmap : MonoBehaviour
{
    public Texture2D lightmap;
    [Tooltip("Factor on the light: as bright as Relume showed it.")]
    public float exposure = @FACTOR@f;

    Texture2D scaled;

    void OnEnable()
    {
        if (lightmap == null) return;
        // Unity has no exposure of its own for lightmaps: the factor goes into a copy.
        var readable = RenderTexture.GetTemporary(lightmap.width, lightmap.height, 0, RenderTextureFormat.ARGBHalf,
                                                  RenderTextureReadWrite.Linear);
        Graphics.Blit(lightmap, readable);
        var before = RenderTexture.active;
        RenderTexture.active = readable;
        scaled = new Texture2D(lightmap.width, lightmap.height, TextureFormat.RGBAHalf, false, true);
        scaled.ReadPixels(new Rect(0, 0, lightmap.width, lightmap.height), 0, 0);
        RenderTexture.active = before;
        RenderTexture.ReleaseTemporary(readable);
        var pixels = scaled.GetPixels();
        for (var i = 0; i < pixels.Length; ++i) pixels[i] *= exposure;
        scaled.SetPixels(pixels);
        scaled.wrapMode = TextureWrapMode.Clamp;
        scaled.Apply();

        LightmapSettings.lightmapsMode = LightmapsMode.NonDirectional;
        LightmapSettings.lightmaps = new[] { new LightmapData { lightmapColor = scaled } };
        foreach (var part in GetComponentsInChildren<MeshRenderer>())
        {
            var mesh = part.GetComponent<MeshFilter>().sharedMesh;
            if (!mesh.HasVertexAttribute(UnityEngine.Rendering.VertexAttribute.TexCoord1)) continue;
            part.lightmapIndex = 0;
            part.lightmapScaleOffset = new Vector4(1, 1, 0, 0);
        }
    }

    // The lightmap may be put in after the component.
    void Update()
    {
        if (lightmap != null && scaled == null) OnEnable();
    }

    void OnDisable()
    {
        LightmapSettings.lightmaps = new LightmapData[0];
        if (scaled != null) DestroyImmediate(scaled);
        scaled = null;
    }
}
