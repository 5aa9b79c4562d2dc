// As much of UnityEngine as examples/unity uses, for tests that run without Unity.
namespace UnityEngine {

  public struct Vector3 {
    public float x, y, z;
    public Vector3(float x, float y, float z) {
      this.x = x;
      this.y = y;
      this.z = z;
    }
  }
  public class Transform {
    public Vector3 position;
    public Vector3 InverseTransformPoint(Vector3 point) {
      return point;
    }
  }
  public class MeshFilter {
    public Mesh mesh;
  }
  public class MonoBehaviour {
    public Transform transform = new Transform();
    readonly MeshFilter filter = new MeshFilter();
    public T GetComponent<T>() {
      return (T)(object)filter;
    }
  }
  public enum MeshTopology { Triangles }
  public enum KeyCode { F5, F9 }
  public static class Input {
    public static bool Down, Held, Up;
    public static KeyCode? Key;
    public static bool GetMouseButtonDown(int button) {
      return Down;
    }
    public static bool GetMouseButton(int button) {
      return Held;
    }
    public static bool GetMouseButtonUp(int button) {
      return Up;
    }
    public static bool GetKeyDown(KeyCode key) {
      return Key == key;
    }
  }
  public class Mesh {
    public Rendering.IndexFormat indexFormat;
    public int vertexCount, Layouts;
    public float[] Positions, Normals;
    public int[] Indices;
    public void MarkDynamic() {}
    public void Clear() {
      vertexCount = 0;
    }
    public void SetVertexBufferParams(int count, params Rendering.VertexAttributeDescriptor[] attributes) {
      vertexCount = count;
      ++Layouts;
    }
    public void SetVertexBufferData(float[] data, int start, int meshStart, int count, int stream) {
      if (count != 3 * vertexCount)
        throw new System.ArgumentException("as many numbers as the layout has vertices");
      if (stream == 0)
        Positions = (float[])data.Clone();
      else
        Normals = (float[])data.Clone();
    }
    public void SetIndices(int[] indices, MeshTopology topology, int part) {
      Indices = (int[])indices.Clone();
    }
    public void RecalculateBounds() {}
  }

  namespace Rendering {
    public enum IndexFormat { UInt32 }
    public enum VertexAttribute { Position, Normal }
    public struct VertexAttributeDescriptor {
      public VertexAttributeDescriptor(VertexAttribute attribute, int stream) {}
    }
  }  // namespace Rendering

}  // namespace UnityEngine
