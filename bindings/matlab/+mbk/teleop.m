function [result, info] = teleop(varargin)
% mbk.teleop  Absolute stability of a teleoperation system.
%
%   RESULT = mbk.teleop(...) returns the JSON document of 'mbk teleop --json' as a struct, in full precision.
%   [RESULT, INFO] = mbk.teleop(...) also returns INFO.text (the JSON document itself), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.teleop('design.toml', NAME, VALUE, ...)
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
%   See also mbk.passivity
  [result, info] = mbk.internal.run('teleop', varargin);
end
