// Calls lobe_c from C#: driver.exe DATA FOLDER. Prints what failed and returns 1.
using System;
using System.Collections.Generic;
using System.IO;
using System.Reflection;
using System.Runtime.InteropServices;
using System.Threading;
using Lobe;

static class Driver {
  static int failures;
  static string data, folder;
  static readonly double[] point = { 0.082, -0.045, 0.035 };  // on the liver of data/

  static void Check(bool holds, string what) {
    if (holds)
      return;
    ++failures;
    Console.Error.WriteLine("FAILED: " + what);
  }
  static LobeException Refused(Action action, string what) {
    try {
      action();
    } catch (LobeException e) {
      return e;
    }
    Check(false, what + " is refused");
    return null;
  }
  static double[] Pose(double x, double y, double z) {
    return new[] { x, y, z, 0, 0, 0, 1 };
  }
  static string Scene {
    get { return Path.Combine(data, "scenes/liver_hands.json"); }
  }

  static float Highest(float[] positions, int axis) {
    float highest = float.NegativeInfinity;
    for (int i = axis; i < positions.Length; i += 3) highest = Math.Max(highest, positions[i]);
    return highest;
  }

  static void Lift(Organ organ) {
    organ.Grasp(1, point, 0.015);
    for (int i = 0; i < 110; ++i) {
      organ.Move(1, Pose(point[0], point[1], point[2] + 0.0005 * Math.Min(i, 80)));
      organ.Advance();
    }
  }

  static void TestSizes(string[] expected) {
    var types = new Dictionary<string, Type> { { "lobe_options", typeof(Options) },
                                               { "lobe_state", typeof(State) },
                                               { "lobe_tool", typeof(Tool) },
                                               { "lobe_haptic_device", typeof(HapticDevice) },
                                               { "lobe_surface",
                                                 typeof(Organ).Assembly.GetType("Lobe.NativeSurface") } };
    Check(expected.Length == types.Count, "every struct of the header is compared");
    foreach (string line in expected) {
      var words = line.Split(' ');
      Check(Marshal.SizeOf(types[words[0]]) == int.Parse(words[1]), "the size of " + line);
    }
  }

  static void TestPullCutAndRestore() {
    using (var organ = new Organ(Scene)) {
      var surface = new Surface();
      organ.Advance();
      Check(organ.Update(surface), "there is a surface after a frame");
      Check(!organ.Update(surface), "the same frame is not copied again");
      float before = Highest(surface.Positions, 2);
      ulong topology = surface.Topology;
      Lift(organ);
      organ.Update(surface);
      Check(Highest(surface.Positions, 2) > before + 0.015f,
            "a hand that rises by 40 mm lifts the liver by 15 mm");
      Check(surface.Topology == topology, "a pull changes no triangle");
      Tool hand;
      Check(organ.TryGetTool(1, out hand) && hand.Holds == 1 && hand.Vertices > 0, "the hand holds");
      Check(hand.Force[2] < -0.2, "the liver pulls the hand down");
      Check(!organ.TryGetTool(7, out hand), "there is no tool 7");

      string file = Path.Combine(folder, "lifted ä.lobe");
      organ.Save(file);
      double time = organ.State.Time;
      organ.Release(1);
      organ.Cautery(2, point, 0.012);
      organ.Switch(2, true);
      organ.Advance(4);
      Check(organ.Update(surface) && surface.Topology != topology, "a cautery changes triangles");
      Check(Array.IndexOf(surface.Cut, (byte)2) >= 0, "some triangles are burnt ones");
      Check(surface.Regions.Length * 3 == surface.Indices.Length, "there is a region per triangle");
      organ.Bring(3, "{\"type\": \"probe\", \"shape\": {\"sphere\": {\"radius\": 0.01}}, \"at\": [0, 0, 1]}");
      organ.Advance(2);
      Check(organ.TryGetTool(3, out hand) && hand.Force[2] == 0, "a probe far away feels nothing");
      Check(Refused(() => organ.Bring(4, "{\"type\": \"saw\", \"at\": [0, 0, 1]}"), "a saw").Status ==
                Status.BadInput,
            "its status");
      organ.Restore(file);
      organ.Advance();
      Check(organ.State.Time < time + 0.02, "a restored session goes on from the saved time");
    }
  }

  static void TestThreads() {
    using (var organ = new Organ(Scene, new Options { Threads = 1 })) {
      organ.Start();
      Check(Refused(() => organ.Advance(), "Advance() while started").Status == Status.WrongState,
            "its status");
      organ.Grasp(1, point, 0.015);
      Tool hand;
      for (int i = 0; i < 1000 && !organ.TryGetTool(1, out hand); ++i) Thread.Sleep(10);
      organ.AttachHaptic(1);
      var f = new double[3];
      double largest = 0;
      var servo = new Thread(() => {
        for (int i = 0; i < 1500; ++i) {
          organ.HapticForce(1, new[] {point[0], point[1], point[2] + 2e-5 * i}, new double[3], f);
      largest = Math.Max(largest, Math.Abs(f[2]));
      Thread.Sleep(1);
    }
  });
  servo.Start();
  servo.Join();
  organ.DetachHaptic(1);
  Check(largest > 0.1 && largest <= 3, "the device feels the liver: " + largest + " N");
  organ.Stop();
}
}

static void TestRefusals() {
  Check(Refused(() => new Organ("no such scene ä.json"), "a missing file")
            .Message.Contains("no such scene ä.json"),
        "the message names the file, in UTF-8");
  Check(Refused(() => Organ.FromText("{", data), "half a scene").Status == Status.BadInput, "its status");
  Refused(() => new Organ(Scene, new Options { Threads = 1000 }), "1000 threads");
  using (var organ = new Organ(Scene)) {
    try {
      organ.Move(1, new double[3]);
      Check(false, "a pose of three numbers is refused");
    } catch (ArgumentException) {
    }
    organ.GraspRay(3, new double[] { 9, 9, 9 }, new double[] { 1, 0, 0 }, 0.01);
    organ.Advance(2);
    ulong after = 0;
    var messages = organ.Messages(ref after);
    Check(messages.Count > 0 && after > 0, "a ray that meets nothing is said");
    Check(organ.Messages(ref after).Count == 0, "no message is given twice");
  }
  var closed = new Organ(Scene);
  closed.Dispose();
  try {
    closed.Advance();
    Check(false, "a closed organ is refused");
  } catch (ObjectDisposedException) {
  }
}

static void Call(object component, string method) {
  component.GetType()
      .GetMethod(method, BindingFlags.NonPublic | BindingFlags.Instance)
      .Invoke(component, null);
}

static void TestUnity() {
  var organ = new LobeOrgan { scene = Scene, saved = Path.Combine(folder, "unity.lobe"),
                              hand = new UnityEngine.Transform() };
  Call(organ, "Start");
  var mesh = organ.GetComponent<UnityEngine.MeshFilter>().mesh;
  float lowest = 0, highest = 0, rise = 0;
  Action<Func<bool>> play = done => {  // frames of the engine, until it is done or half a minute has passed
    for (int frame = 0; frame < 1500 && !done(); ++frame) {
      organ.hand.position = new UnityEngine.Vector3(0.082f, 0.035f + rise, -0.045f);  // y up
      Call(organ, "Update");
      UnityEngine.Input.Down = UnityEngine.Input.Up = false;
      UnityEngine.Input.Key = null;
      Thread.Sleep(20);
      if (mesh.Positions != null)
        highest = Highest(mesh.Positions, 1);
    }
  };
  play(() => mesh.Positions != null);
  lowest = highest;
  UnityEngine.Input.Down = UnityEngine.Input.Held = true;
  play(() => (rise = Math.Min(0.04f, rise + 0.0005f)) == 0.04f && highest > lowest + 0.015f);
  Check(highest > lowest + 0.015f, "the hand lifts the organ by 15 mm: " + lowest + " to " + highest + " m");
  UnityEngine.Input.Key = UnityEngine.KeyCode.F5;
  play(() => File.Exists(organ.saved));
  UnityEngine.Input.Held = false;
  UnityEngine.Input.Up = true;
  play(() => highest < lowest + 0.005f);
  Check(highest < lowest + 0.005f, "the organ falls when it is let go");
  UnityEngine.Input.Key = UnityEngine.KeyCode.F9;
  play(() => highest > lowest + 0.015f);
  Check(highest > lowest + 0.015f, "F9 goes back to the lifted organ");
  Check(mesh.Layouts == 1 && mesh.Indices.Length > 1000, "triangles are uploaded once");
  Call(organ, "OnDestroy");
}

static int Main(string[] arguments) {
  data = arguments[0];
  folder = arguments[1];
  TestSizes(File.ReadAllLines(arguments[2]));
  TestRefusals();
  TestPullCutAndRestore();
  TestThreads();
  TestUnity();
  Console.WriteLine(failures == 0 ? "all passed" : failures + " failed");
  return failures == 0 ? 0 : 1;
}
}
