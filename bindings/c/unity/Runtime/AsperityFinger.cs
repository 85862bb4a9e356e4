// A finger: casts along its forward axis, and touches the AsperityBody it meets. Put it on a fingertip; its channel is felt.
using UnityEngine;

namespace Asperity
{
    public sealed class AsperityFinger : MonoBehaviour
    {
        [Tooltip("How far in front of the transform it touches, m")]
        public float ReachM = 0.02f;
        [Tooltip("Force for each metre that it is pushed in, N/m")]
        public float StiffnessNM = 100f;
        public int HapticChannel;

        static ulong names;
        ulong contact;
        AsperityBody touched;
        Scene scene;
        Vector2 uv;

        void FixedUpdate()
        {
            var world = AsperityWorld.Current;
            if (world == null || world.Scene == null) return;
            RaycastHit hit;
            var found = Physics.Raycast(transform.position, transform.forward, out hit, ReachM) ? hit.collider.GetComponent<AsperityBody>() : null;
            if (found != touched || world.Scene != scene) Lift(world);
            if (found == null || !found.Join() || found.Surface == 0) return;
            // Mesh colliders know texture coordinates; any other is a plane in the world.
            uv = hit.collider is MeshCollider ? hit.textureCoord : found.PlaneUv(hit.point);
            double force = StiffnessNM * (ReachM - hit.distance);
            if (touched == null)
            {
                contact = ++names;
                touched = found;
                scene = world.Scene;
                world.Report(Event.Begin(contact, found.Surface, HapticChannel, uv.x, uv.y, force));
            }
            else world.Report(Event.Move(contact, uv.x, uv.y, force));
        }

        void Lift(AsperityWorld world)
        {
            // A contact of an engine that is gone has ended with it.
            if (touched != null && world.Scene == scene) world.Report(Event.End(contact));
            touched = null;
        }

        void OnDisable()
        {
            if (AsperityWorld.Current != null) Lift(AsperityWorld.Current);
        }
    }
}
