function [result, info] = validate(varargin)
% mbk.validate  Test a method against known truth.
%
%   RESULT = mbk.validate(...) returns the JSON document of 'mbk validate --json' as a struct, in full precision.
%   [RESULT, INFO] = mbk.validate(...) also returns INFO.text (the JSON document itself), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.validate('coverage', 'runs', 200, 'seed', 1)
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
  [result, info] = mbk.internal.run('validate', varargin);
end
