//! The flat telemetry message: one double for each column of a row, described by a protobuf
//! schema that is generated from the signal table.

use prost::Message;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet};

use crate::layout::Layout;

pub const MESSAGE: &str = "lander.Telemetry";

/// Serialised `FileDescriptorSet` with the one message.
pub fn descriptor_set(layout: &Layout) -> Vec<u8> {
    let field = layout
        .column_names()
        .zip(1..)
        .map(|(column, number)| FieldDescriptorProto {
            name: Some(field_name(&column)),
            number: Some(number),
            label: Some(Label::Optional as i32),
            r#type: Some(Type::Double as i32),
            ..Default::default()
        })
        .collect();
    let message =
        DescriptorProto { name: Some("Telemetry".to_owned()), field, ..Default::default() };
    let file = FileDescriptorProto {
        name: Some("lander/telemetry.proto".to_owned()),
        package: Some("lander".to_owned()),
        message_type: vec![message],
        syntax: Some("proto3".to_owned()),
        ..Default::default()
    };
    FileDescriptorSet { file: vec![file] }.encode_to_vec()
}

/// `position_w[1]` becomes `position_w_1`: a protobuf name has no brackets.
fn field_name(column: &str) -> String {
    column.replace('[', "_").replace(']', "")
}

/// Writes every column, zeros too, so that no reader takes a zero for a gap.
pub fn encode(row: &[f64], buffer: &mut Vec<u8>) {
    buffer.clear();
    for (value, number) in row.iter().zip(1..) {
        prost::encoding::double::encode(number, value, buffer);
    }
}
