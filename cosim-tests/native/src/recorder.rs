//! Writes the MCAP log. The only file that names the writer.
//!
//! Log time is simulation time, so equal rows give equal bytes.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use foxglove::messages::{
    CylinderPrimitive, Duration, FrameTransform, FrameTransforms, LinePrimitive,
    PackedElementField, Point3, PointCloud, Pose, PoseInFrame, Quaternion, SceneEntity,
    SceneUpdate, SpherePrimitive, Timestamp, TriangleListPrimitive, Vector3, line_primitive,
    packed_element_field::NumericType,
};
use foxglove::{
    Channel, Context, FoxgloveError, McapCompression, McapWriteOptions, McapWriterHandle,
    PartialMetadata, RawChannel, Schema,
};
use lander_models::Ticks;
use lander_models::frames::attitude_from_wxyz;
use lander_models::signals::{ATTITUDE_WB, POSITION_W};
use nalgebra::{UnitQuaternion, Vector3 as Vector};

use crate::layout::Layout;
use crate::scene::{Color, Entity, Frustum, Lines, Scene, Sphere, Triangles};
use crate::{telemetry, urdf};

const WORLD: &str = "world";
const LANDER: &str = "lander";
/// 50 Hz: smooth to the eye.
const POSE_PERIOD: Ticks = Ticks(20);
/// 20 Hz.
const PLUME_PERIOD: Ticks = Ticks(50);

#[derive(Debug, thiserror::Error)]
#[error("{}: the log cannot be written (is the disk full?): {source}", file.display())]
pub struct RecorderError {
    file: PathBuf,
    source: FoxgloveError,
}

pub struct Recorder {
    file: PathBuf,
    /// Channels and writer know it only weakly.
    _context: Arc<Context>,
    writer: McapWriterHandle<BufWriter<File>>,
    layout: Layout,
    scene: Scene,
    scenery: Channel<SceneUpdate>,
    transforms: Channel<FrameTransforms>,
    pose: Channel<PoseInFrame>,
    plume: Channel<SceneUpdate>,
    /// For viewers that draw no scene entities: the lander as a robot, the ground as points.
    robot: Arc<RawChannel>,
    terrain: Channel<PointCloud>,
    telemetry: Arc<RawChannel>,
    buffer: Vec<u8>,
}

impl Recorder {
    /// Creates `file`, replacing an older one.
    pub fn create(file: &Path, layout: &Layout, scene: Scene) -> Result<Self, RecorderError> {
        Self::open(file, layout, scene)
            .map_err(|source| RecorderError { file: file.to_owned(), source })
    }

    fn open(file: &Path, layout: &Layout, scene: Scene) -> Result<Self, FoxgloveError> {
        let context = Context::new();
        let options = McapWriteOptions::new().compression(Some(McapCompression::Lz4));
        let writer = context
            .mcap_writer_with_options(options)
            .create(BufWriter::new(File::create(file)?))?;
        let schema = Schema::new(telemetry::MESSAGE, "protobuf", telemetry::descriptor_set(layout));
        let telemetry = context
            .channel_builder("/telemetry")
            .message_encoding("protobuf")
            .schema(schema)
            .build_raw()?;
        let text = Schema::new("std_msgs/msg/String", "ros2msg", &b"string data\n"[..]);
        let robot = context
            .channel_builder("/robot_description")
            .message_encoding("cdr")
            .schema(text)
            .build_raw()?;
        Ok(Self {
            file: file.to_owned(),
            writer,
            layout: layout.clone(),
            scene,
            scenery: context.channel_builder("/scene").build(),
            transforms: context.channel_builder("/tf").build(),
            pose: context.channel_builder("/pose").build(),
            plume: context.channel_builder("/plume").build(),
            robot,
            terrain: context.channel_builder("/terrain").build(),
            telemetry,
            _context: context,
            buffer: Vec::new(),
        })
    }

    pub fn row(&mut self, time: Ticks, row: &[f64]) {
        let stamp = Stamp::at(time);
        if time == Ticks::ZERO {
            let update = SceneUpdate {
                deletions: Vec::new(),
                entities: vec![
                    entity(&self.scene.ground, "ground", WORLD, stamp, None),
                    entity(&self.scene.lander, "lander", LANDER, stamp, None),
                ],
            };
            self.scenery.log_with_meta(&update, stamp.meta());
            let robot = ros_string(&urdf::of(&self.scene.lander, LANDER));
            self.robot.log_with_meta(&robot, stamp.meta());
            let terrain = cloud(&self.scene.ground_points_w, stamp);
            self.terrain.log_with_meta(&terrain, stamp.meta());
        }
        if time.0.is_multiple_of(POSE_PERIOD.0) {
            self.pose_row(stamp, row);
        }
        if time.0.is_multiple_of(PLUME_PERIOD.0) {
            self.plume_row(stamp, row);
        }
        telemetry::encode(row, &mut self.buffer);
        self.telemetry.log_with_meta(&self.buffer, stamp.meta());
    }

    fn pose_row(&self, stamp: Stamp, row: &[f64]) {
        let (Some(position_w), Some(wxyz)) = (
            self.layout.vector::<3>(row, POSITION_W.name),
            self.layout.vector::<4>(row, ATTITUDE_WB.name),
        ) else {
            return;
        };
        let position_w = Vector::from(position_w);
        let rotation = quaternion(&attitude_from_wxyz(wxyz));
        let transform = FrameTransform {
            timestamp: Some(stamp.message()),
            parent_frame_id: WORLD.to_owned(),
            child_frame_id: LANDER.to_owned(),
            translation: Some(vector(&position_w)),
            rotation: Some(rotation),
        };
        self.transforms
            .log_with_meta(&FrameTransforms { transforms: vec![transform] }, stamp.meta());
        let pose = PoseInFrame {
            timestamp: Some(stamp.message()),
            frame_id: WORLD.to_owned(),
            pose: Some(Pose { position: Some(vector(&position_w)), orientation: Some(rotation) }),
        };
        self.pose.log_with_meta(&pose, stamp.meta());
    }

    fn plume_row(&self, stamp: Stamp, row: &[f64]) {
        let thrust_n = self.layout.scalar(row, "thrust_n");
        let gimbal_rad = self.layout.vector::<2>(row, "gimbal_rad").unwrap_or_default();
        let plume = self.scene.plume(thrust_n, gimbal_rad);
        // Gone by itself when the log ends with the engine on.
        let lifetime = Some(2 * PLUME_PERIOD.0);
        let entities = vec![entity(&plume, "plume", LANDER, stamp, lifetime)];
        let update = SceneUpdate { deletions: Vec::new(), entities };
        self.plume.log_with_meta(&update, stamp.meta());
    }

    /// Completes the file, so that every reader accepts it.
    pub fn close(self) -> Result<(), RecorderError> {
        let flushed = self.writer.close().and_then(|mut buffer| Ok(buffer.flush()?));
        flushed.map_err(|source| RecorderError { file: self.file, source })
    }
}

/// Simulation time in the two forms a log needs.
#[derive(Clone, Copy)]
struct Stamp {
    nanoseconds: u64,
}

impl Stamp {
    fn at(time: Ticks) -> Self {
        Self { nanoseconds: time.0 * 1_000_000 }
    }

    fn meta(self) -> PartialMetadata {
        PartialMetadata::with_log_time(self.nanoseconds)
    }

    fn message(self) -> Timestamp {
        // A scenario lasts at most 1e6 s.
        Timestamp::new(
            (self.nanoseconds / 1_000_000_000) as u32,
            (self.nanoseconds % 1_000_000_000) as u32,
        )
    }
}

fn entity(
    shapes: &Entity,
    id: &str,
    frame: &str,
    stamp: Stamp,
    lifetime_ms: Option<u64>,
) -> SceneEntity {
    SceneEntity {
        timestamp: Some(stamp.message()),
        frame_id: frame.to_owned(),
        id: id.to_owned(),
        lifetime: lifetime_ms.map(|ms| Duration::new(0, ms as u32 * 1_000_000)),
        frame_locked: true,
        cylinders: shapes.frustums.iter().map(cylinder).collect(),
        lines: shapes.lines.iter().map(line_list).collect(),
        triangles: shapes.triangles.iter().map(triangle_list).collect(),
        spheres: shapes.spheres.iter().map(sphere).collect(),
        ..Default::default()
    }
}

fn cylinder(frustum: &Frustum) -> CylinderPrimitive {
    let widest_m = frustum.bottom_radius_m.max(frustum.top_radius_m);
    let size = Vector::new(2.0 * widest_m, 2.0 * widest_m, frustum.length_m);
    CylinderPrimitive {
        pose: Some(Pose {
            position: Some(vector(&frustum.center)),
            orientation: Some(quaternion(&frustum.attitude)),
        }),
        size: Some(vector(&size)),
        bottom_scale: frustum.bottom_radius_m / widest_m,
        top_scale: frustum.top_radius_m / widest_m,
        color: Some(color(frustum.color)),
    }
}

fn sphere(sphere: &Sphere) -> SpherePrimitive {
    SpherePrimitive {
        pose: Some(Pose { position: Some(vector(&sphere.center)), ..origin() }),
        size: Some(vector(&Vector::repeat(2.0 * sphere.radius_m))),
        color: Some(color(sphere.color)),
    }
}

/// Points as three little-endian 32-bit floats each.
fn cloud(points_w: &[Vector<f64>], stamp: Stamp) -> PointCloud {
    let field = |(index, name): (u32, &str)| PackedElementField {
        name: name.to_owned(),
        offset: 4 * index,
        r#type: NumericType::Float32 as i32,
    };
    let floats = points_w.iter().flatten().flat_map(|value| (*value as f32).to_le_bytes());
    PointCloud {
        timestamp: Some(stamp.message()),
        frame_id: WORLD.to_owned(),
        pose: Some(origin()),
        point_stride: 12,
        fields: (0..).zip(["x", "y", "z"]).map(field).collect(),
        data: floats.collect::<Vec<u8>>().into(),
    }
}

/// A `std_msgs/msg/String` in CDR: little-endian header, length with the closing zero, text.
fn ros_string(text: &str) -> Vec<u8> {
    let length = text.len() as u32 + 1;
    let header = [0, 1, 0, 0].into_iter().chain(length.to_le_bytes());
    header.chain(text.bytes()).chain([0]).collect()
}

fn line_list(lines: &Lines) -> LinePrimitive {
    LinePrimitive {
        r#type: line_primitive::Type::LineList as i32,
        pose: Some(origin()),
        thickness: lines.thickness_m,
        points: points(&lines.points),
        color: Some(color(lines.color)),
        ..Default::default()
    }
}

fn triangle_list(triangles: &Triangles) -> TriangleListPrimitive {
    TriangleListPrimitive {
        pose: Some(origin()),
        points: points(&triangles.points),
        indices: triangles.corners.clone(),
        color: Some(color(triangles.color)),
        ..Default::default()
    }
}

fn origin() -> Pose {
    Pose {
        position: Some(vector(&Vector::zeros())),
        orientation: Some(quaternion(&UnitQuaternion::identity())),
    }
}

fn points(points: &[Vector<f64>]) -> Vec<Point3> {
    points.iter().map(|p| Point3 { x: p.x, y: p.y, z: p.z }).collect()
}

fn vector(v: &Vector<f64>) -> Vector3 {
    Vector3 { x: v.x, y: v.y, z: v.z }
}

fn quaternion(q: &UnitQuaternion<f64>) -> Quaternion {
    Quaternion { x: q.i, y: q.j, z: q.k, w: q.w }
}

fn color([r, g, b, a]: Color) -> foxglove::messages::Color {
    foxglove::messages::Color { r, g, b, a }
}
