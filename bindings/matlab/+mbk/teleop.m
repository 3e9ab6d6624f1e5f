function [result, info] = teleop(varargin)
% mbk.teleop  Absolute stability of a teleoperator.
%
%   RESULT = mbk.teleop(...) is the document that 'mbk teleop --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.teleop(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.teleop('design.toml', NAME, VALUE, ...)
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
%   See also mbk.passivity
  [result, info] = mbk.internal.run('teleop', varargin);
end
