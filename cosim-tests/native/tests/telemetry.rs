//! The generated telemetry schema describes the generated telemetry message.

use std::collections::BTreeMap;

use cosim::layout::Layout;
use cosim::schedule::{Pair, Schedule};
use cosim::telemetry;
use lander_models::signals::{GUIDANCE, Interface, TRUTH};
use prost::Message;
use prost_types::FileDescriptorSet;

static INTERFACES: Pair<&Interface> = Pair { truth: &TRUTH, guidance: &GUIDANCE };

/// Reads a message of doubles by the wire format alone: tag, then eight bytes.
fn decode(mut bytes: &[u8]) -> BTreeMap<i32, f64> {
    let mut fields = BTreeMap::new();
    while !bytes.is_empty() {
        let key = prost::encoding::decode_varint(&mut bytes).unwrap();
        assert_eq!(key & 7, 1, "wire type of a double");
        let (word, rest) = bytes.split_first_chunk().unwrap();
        fields.insert((key >> 3) as i32, f64::from_le_bytes(*word));
        bytes = rest;
    }
    fields
}

#[test]
fn every_column_comes_back_under_its_name_and_bit_for_bit() {
    let schedule = Schedule::load(&INTERFACES).unwrap();
    let layout = Layout::new(&schedule, &INTERFACES);
    let mut row: Vec<f64> = (0..layout.width()).map(|n| 0.1 * n as f64).collect();
    row[3] = f64::NAN;
    let mut message = Vec::new();
    telemetry::encode(&row, &mut message);
    let values = decode(&message);

    let schema = telemetry::descriptor_set(&layout);
    let files = FileDescriptorSet::decode(schema.as_slice()).unwrap().file;
    let fields = &files[0].message_type[0].field;
    assert_eq!(fields.len(), layout.width());
    for ((field, column), value) in fields.iter().zip(layout.column_names()).zip(&row) {
        let spelled = column.replace('[', "_").replace(']', "");
        assert_eq!(field.name(), spelled);
        assert_eq!(values[&field.number()].to_bits(), value.to_bits(), "{column}");
    }
}
