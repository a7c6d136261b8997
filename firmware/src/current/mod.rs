//! stub
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerFault {
    A,
}
impl PowerFault {
    pub const fn as_str(self) -> &'static str {
        ""
    }
    pub const fn encode(self) -> (u32, [u32; 2]) {
        (14, [0; 2])
    }
    pub const fn decode(_: u32, _: [u32; 2]) -> Option<Self> {
        None
    }
}
impl core::fmt::Display for PowerFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("x")
    }
}
