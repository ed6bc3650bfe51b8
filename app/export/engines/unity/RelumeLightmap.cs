// Lights a level that Relume exported by its lightmap (Unity 2022.3 or newer, linear colour space).
//
// 1. Copy the exported folder into Assets. scene.glb needs an importer of glTF files: package com.unity.cloud.gltfast.
@ONE@// 2. Set lightmap.exr to texture type Default, sRGB off, compression None or BC6H, wrap mode Clamp, mipmaps off.
@MANY@// 2. Set lightmap.0.exr and so on to texture type Default, sRGB off, compression None or BC6H, wrap mode Clamp, mipmaps
@MANY@//    off, and their maximum size to theirs.
// 3. Project Settings: Player > Lightmap Encoding "High Quality"; Graphics > Lightmap Modes "Custom" with "Baked
//    Non-Directional". Lighting window: no ambient light, and no reflections of the environment.
@ONE@// 4. Put scene.glb into a scene, this component on its root, and lightmap.exr into the component's field.
@MANY@// 4. Put scene.glb into a scene, this component on its root, and the @PAGES@ pages of the lightmap into the component's
@MANY@//    field, in their order.
//
// The lightmap has lighting in cd/m^2; Exposure brings it to the screen. The level's emission is there already, and
// ends at white, as glTFast knows no brighter one.
using System.Collections.Generic;
using UnityEngine;

[ExecuteAlways]
public class RelumeLightmap : MonoBehaviour
{
@ONE@    public Texture2D lightmap;
@MANY@    public Texture2D[] lightmaps = new Texture2D[@PAGES@];
    [Tooltip("Factor on the light: as bright as Relume showed it.")]
    public float exposure = @FACTOR@f;

@MANY@    // The pages that light materials, by their names.
@MANY@    static readonly Dictionary<string, int> pageOf = new Dictionary<string, int>
@MANY@    {
@MANY@@EACH@        { "@MATERIAL@", @PAGE@ },
@MANY@    };

    readonly List<Texture2D> scaled = new List<Texture2D>();

@ONE@    bool IsThere() => lightmap != null;
@MANY@    bool IsThere() => lightmaps.Length == @PAGES@ && System.Array.TrueForAll(lightmaps, page => page != null);

    // Unity has no exposure of its own for lightmaps: the factor goes into a copy.
    LightmapData Exposed(Texture2D lightmap)
    {
        var readable = RenderTexture.GetTemporary(lightmap.width, lightmap.height, 0, RenderTextureFormat.ARGBHalf,
                                                  RenderTextureReadWrite.Linear);
        Graphics.Blit(lightmap, readable);
        var before = RenderTexture.active;
        RenderTexture.active = readable;
        var copy = new Texture2D(lightmap.width, lightmap.height, TextureFormat.RGBAHalf, false, true);
        copy.ReadPixels(new Rect(0, 0, lightmap.width, lightmap.height), 0, 0);
        RenderTexture.active = before;
        RenderTexture.ReleaseTemporary(readable);
        var pixels = copy.GetPixels();
        for (var i = 0; i < pixels.Length; ++i) pixels[i] *= exposure;
        copy.SetPixels(pixels);
        copy.wrapMode = TextureWrapMode.Clamp;
        copy.Apply();
        scaled.Add(copy);
        return new LightmapData { lightmapColor = copy };
    }

    void OnEnable()
    {
        if (!IsThere()) return;
        LightmapSettings.lightmapsMode = LightmapsMode.NonDirectional;
@ONE@        LightmapSettings.lightmaps = new[] { Exposed(lightmap) };
@MANY@        LightmapSettings.lightmaps = System.Array.ConvertAll(lightmaps, Exposed);
        foreach (var part in GetComponentsInChildren<MeshRenderer>())
        {
            var mesh = part.GetComponent<MeshFilter>().sharedMesh;
            if (!mesh.HasVertexAttribute(UnityEngine.Rendering.VertexAttribute.TexCoord1)) continue;
@ONE@            part.lightmapIndex = 0;
@MANY@            part.lightmapIndex = PageOf(part);
            part.lightmapScaleOffset = new Vector4(1, 1, 0, 0);
        }
    }

@MANY@    // All that the lightmap lights of an object is on one page.
@MANY@    static int PageOf(MeshRenderer part)
@MANY@    {
@MANY@        foreach (var material in part.sharedMaterials)
@MANY@            if (material != null && pageOf.TryGetValue(material.name, out var page)) return page;
@MANY@        return 0;
@MANY@    }
@MANY@
    // The lightmap may be put in after the component.
    void Update()
    {
        if (IsThere() && scaled.Count == 0) OnEnable();
    }

    void OnDisable()
    {
        LightmapSettings.lightmaps = new LightmapData[0];
        foreach (var copy in scaled) DestroyImmediate(copy);
        scaled.Clear();
    }
}
