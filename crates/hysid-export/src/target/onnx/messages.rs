//! Those messages of ONNX that the export writes. Tags and types: onnx.proto of ONNX.

use prost::Message;

/// Numbers of data types.
pub(super) const BOOL: i32 = 9;
pub(super) const INT64: i32 = 7;
pub(super) const DOUBLE: i32 = 11;

#[derive(Clone, PartialEq, Message)]
pub(super) struct OnnxModel {
    #[prost(int64, tag = "1")]
    pub ir_version: i64,
    #[prost(string, tag = "2")]
    pub producer_name: String,
    #[prost(string, tag = "3")]
    pub producer_version: String,
    #[prost(string, tag = "6")]
    pub doc_string: String,
    #[prost(message, optional, tag = "7")]
    pub graph: Option<Graph>,
    #[prost(message, repeated, tag = "8")]
    pub opset_import: Vec<OperatorSet>,
    #[prost(message, repeated, tag = "14")]
    pub metadata: Vec<OnnxEntry>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct OperatorSet {
    #[prost(string, tag = "1")]
    pub domain: String,
    #[prost(int64, tag = "2")]
    pub version: i64,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct OnnxEntry {
    #[prost(string, tag = "1")]
    pub key: String,
    #[prost(string, tag = "2")]
    pub value: String,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Graph {
    #[prost(message, repeated, tag = "1")]
    pub nodes: Vec<OnnxNode>,
    #[prost(string, tag = "2")]
    pub name: String,
    #[prost(message, repeated, tag = "5")]
    pub initializers: Vec<Tensor>,
    #[prost(message, repeated, tag = "11")]
    pub inputs: Vec<ValueInfo>,
    #[prost(message, repeated, tag = "12")]
    pub outputs: Vec<ValueInfo>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct OnnxNode {
    #[prost(string, repeated, tag = "1")]
    pub inputs: Vec<String>,
    #[prost(string, repeated, tag = "2")]
    pub outputs: Vec<String>,
    #[prost(string, tag = "4")]
    pub operation: String,
    #[prost(message, repeated, tag = "5")]
    pub attributes: Vec<Attribute>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Attribute {
    #[prost(string, tag = "1")]
    pub name: String,
    #[prost(int64, tag = "3")]
    pub integer: i64,
    #[prost(message, optional, tag = "6")]
    pub graph: Option<Graph>,
    #[prost(int32, tag = "20")]
    pub kind: i32,
}

impl Attribute {
    pub fn integer(name: &str, value: usize) -> Self {
        const INTEGER: i32 = 2;
        let integer = i64::try_from(value).unwrap_or(i64::MAX);
        Self { name: name.into(), integer, graph: None, kind: INTEGER }
    }

    pub fn graph(name: &str, graph: Graph) -> Self {
        const GRAPH: i32 = 5;
        Self { name: name.into(), integer: 0, graph: Some(graph), kind: GRAPH }
    }
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Tensor {
    #[prost(int64, repeated, tag = "1")]
    pub dims: Vec<i64>,
    #[prost(int32, tag = "2")]
    pub data_type: i32,
    #[prost(string, tag = "8")]
    pub name: String,
    #[prost(bytes = "vec", tag = "9")]
    pub raw: Vec<u8>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct ValueInfo {
    #[prost(string, tag = "1")]
    pub name: String,
    #[prost(message, optional, tag = "2")]
    pub kind: Option<Type>,
    #[prost(string, tag = "3")]
    pub doc_string: String,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Type {
    #[prost(message, optional, tag = "1")]
    pub tensor: Option<TensorType>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct TensorType {
    #[prost(int32, tag = "1")]
    pub data_type: i32,
    #[prost(message, optional, tag = "2")]
    pub shape: Option<OnnxShape>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct OnnxShape {
    #[prost(message, repeated, tag = "1")]
    pub dims: Vec<OnnxDimension>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct OnnxDimension {
    #[prost(int64, optional, tag = "1")]
    pub value: Option<i64>,
    #[prost(string, optional, tag = "2")]
    pub name: Option<String>,
}

impl ValueInfo {
    pub fn scalar(name: &str, data_type: i32) -> Self {
        Self::of(name, data_type, Vec::new())
    }

    pub fn row(name: &str, length: usize) -> Self {
        let value = Some(i64::try_from(length).unwrap_or(i64::MAX));
        Self::of(name, DOUBLE, vec![OnnxDimension { value, name: None }])
    }

    /// A number for each row of a record.
    pub fn record(name: &str) -> Self {
        Self::of(name, DOUBLE, vec![OnnxDimension { value: None, name: Some("rows".into()) }])
    }

    fn of(name: &str, data_type: i32, dims: Vec<OnnxDimension>) -> Self {
        let tensor = Some(TensorType { data_type, shape: Some(OnnxShape { dims }) });
        Self { name: name.into(), kind: Some(Type { tensor }), doc_string: String::new() }
    }
}
