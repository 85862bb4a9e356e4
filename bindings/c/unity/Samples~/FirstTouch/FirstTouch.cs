// A first touch: put this on any object of an empty scene (the camera, for instance) and play. A steel ball drops onto a wooden plate and rings it;
// a finger strokes the plate back and forth, and what it feels is told on the screen.
using Asperity;
using UnityEngine;

public sealed class FirstTouch : MonoBehaviour
{
    AsperityFinger finger;
    Port port;
    float felt;
    readonly float[] samples = new float[8192];

    void Awake()
    {
        if (AsperityWorld.Current == null) new GameObject("World").AddComponent<AsperityWorld>();
        var plate = GameObject.CreatePrimitive(PrimitiveType.Cube);
        plate.transform.localScale = new Vector3(1f, 0.02f, 1f);
        var rings = plate.AddComponent<AsperityBody>();
        rings.Made = Asperity.Material.Wood;
        rings.SurfaceTable = "solid = \"wood\"";

        var ball = GameObject.CreatePrimitive(PrimitiveType.Sphere);
        ball.transform.localScale = Vector3.one * 0.1f;
        ball.transform.position = new Vector3(0.3f, 1f, 0f);
        ball.AddComponent<Rigidbody>().mass = 0.3f;

        finger = new GameObject("Finger").AddComponent<AsperityFinger>();
        finger.transform.LookAt(finger.transform.position + Vector3.down);
    }

    void Start() { port = AsperityWorld.Current.Scene.Open(PortKind.Pcm, Feed.Haptic, 0, holdsS: 0.5); }

    void FixedUpdate()
    {
        finger.transform.position = new Vector3(0.2f * Mathf.Sin(2f * Time.fixedTime), 0.015f, -0.2f);
    }

    void Update()
    {
        felt = 0f;
        int count = port.Pcm(samples);
        for (int i = 0; i < count; i++) felt = Mathf.Max(felt, Mathf.Abs(samples[i]));
    }

    void OnGUI() { GUI.Label(new Rect(10, 10, 400, 20), "felt: " + felt.ToString("0.0000") + "  " + AsperityWorld.Current.Scene.WhySilent()); }

    void OnDestroy() { if (port != null) port.Dispose(); }
}
